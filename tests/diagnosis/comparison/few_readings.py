"""One wire under few, uneven excursions, and fewer readings than a user's records get: seconds instead of minutes."""

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, triangles
from smarig.diagnosis.comparison.measured import record_readings

WIRE = RelayWire(2)
PEAKS = (88.0, *np.random.default_rng(5).uniform(58, 88, 11).round(1).tolist())
ROWS = [40, 14, 70, 25, 50, 16, 30, 90, 20, 60, 18, 35]
ASIDE = ("input_drift", "output_jump", "time_since_reversal", "speed", "history")  # asked for in other tests


def drive(rows=ROWS):
    """Temperatures of twelve excursions of different heights and rates."""
    return triangles(PEAKS, rows=rows)


@pytest.fixture
def few_readings(monkeypatch):
    """Readings of a record, of training and held-out runs."""
    monkeypatch.setattr(record_readings, "TRAIN_READINGS", 140)
    monkeypatch.setattr(record_readings, "HELD_OUT_READINGS", 50)
