"""Converts the current of imported data to a temperature with the heating model of a rig.

It applies to data that have a mapping and a rig with constants. Recordings in time get the transient temperature
(5.1) and steps found from the current; settled readings get the steady temperature (5.3).
"""

from dataclasses import replace

import numpy as np

from smarig.core import UsageError
from smarig.exchange.runs.hold_steps import Recording, found_steps, holds, tolerance
from smarig.exchange.runs.reader_result import RunDraft
from smarig.exchange.runs.rig_constants import RigConstants
from smarig.record import remarks


def with_heating_model(draft: RunDraft, rig: RigConstants) -> RunDraft:
    """The draft with its input in kelvin above ambient; UsageError if it has no current or another unit."""
    input_meta, unit = draft.meta.get("input", {}), draft.meta.get("output", {}).get("unit")
    if input_meta.get("unit") != "A":
        raise UsageError(
            f"The mapping's input is {input_meta.get('quantity', 'not named')} in "
            f"{input_meta.get('unit') or 'no unit'}. "
            "--rig converts a current to a temperature, so leave it out."
        )
    if unit != rig.actuator.unit:
        raise UsageError(
            f"The mapping gives positions in {unit}, but rig {rig.file.name} measures {rig.actuator.unit}."
        )
    drive, t_s = draft.columns["input"], draft.columns.get("t_s", np.full(len(draft), np.nan))
    steady = np.array([rig.actuator.input_for(i) for i in drive.tolist()])
    timed = bool(np.isfinite(t_s).all())
    columns = {**draft.columns, "input": rig.input_along(t_s, drive) if timed else steady}
    steps = [
        (*row[:4], None if row[4] is None else rig.actuator.input_for(row[4]), *row[5:])
        for row in draft.steps
    ]
    notes: list[str] = []
    if timed and not steps:
        ranges = holds(drive, tolerance(drive))
        recording = Recording(t_s, draft.columns["position"], rig.per_count)
        steps, columns["step"], notes = found_steps(
            recording, ranges, lambda a, b: rig.actuator.input_for(float(np.mean(drive[a:b])))
        )
    meta = draft.meta | {"input": input_description(rig, "heating model along the current, from a cold wire")}
    return replace(
        draft, columns=columns, meta=meta, steps=tuple(steps), findings=(*draft.findings, *remarks(*notes))
    )


def input_description(rig: RigConstants, source: str) -> dict[str, str]:
    """The description of the input of a rig's run: quantity, unit, and source."""
    two = rig.actuator.two_wire
    quantity = "wire temperature difference T₁ − T₂" if two else "wire temperature above ambient"
    return {"quantity": quantity, "unit": "K", "from": source}
