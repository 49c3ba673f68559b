"""An output over decades, as the resistance of a film that turns from an insulator to a metal: its logarithm counts.

On a linear scale the first decade is nearly all of the output, so that the corners of its tangents are those of the
last few per cent of the transformation.
"""

from dataclasses import replace

import numpy as np

from smarig.transformation.temperature_record import TemperatureRecord

DECADE = "decade"
_FEWEST = 1.5  # decades between the least and the largest output
_OF_RATIOS = ("resistance", "resistivity", "modulus")  # whose zero is no matter of the set-up


def in_decades(record: TemperatureRecord, quantity: str | None) -> TemperatureRecord:
    """The record with log10 of its output, if this is positive and spans so much; else as it is."""
    low, high = float(record.y.min()), float(record.y.max())
    if quantity not in _OF_RATIOS or low <= 0 or np.log10(high / low) <= _FEWEST:
        return record
    note = (
        f"The {quantity} spans {np.log10(high / low):.2g} decades: the tangents are those of its logarithm, and "
        "figures of the output are in decades."
    )
    return replace(record, y=np.log10(record.y), unit=DECADE, notes=(*record.notes, note))
