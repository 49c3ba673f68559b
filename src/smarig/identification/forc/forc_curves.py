"""First-order reversal curves of a run, as the mirrored FOD curves of ``ForcTable``.

A FORC starts on the descending branch at a reversal field and rises. Mirrored, (u, y) → (−u, −y), it is a FOD curve
whose peak is the reversal.
"""

from dataclasses import replace

import numpy as np

from smarig.core import Array, DataError
from smarig.preisach import ForcCurve
from smarig.record import FORC_PROTOCOL, Run

CALIBRATION = -1
_MAX_REVERSED_SHARE = 0.1


def curves_from_run(run: Run) -> tuple[ForcCurve, ...]:
    """The curves of a FORC run in measuring order, mirrored: α = −reversal field, β = −field, y = −moment.

    Column ``step`` numbers the curves from 0; −1 marks calibration points in saturation. The last calibration point
    before a curve becomes its ``saturation``. A curve starts at its lowest field. Readings that do not increase the
    field are left out, because they would be reversals by noise. Raises DataError if the run is of another
    protocol, or if the field of a curve falls at more than 10 % of its points.
    """
    if run.info.protocol != FORC_PROTOCOL:
        raise DataError(
            f"{run.path} is of protocol '{run.info.text_of('protocol', 'unknown')}', but reversal curves need "
            f"'{FORC_PROTOCOL}'. Import a FORC file with --format forc."
        )
    known = np.isfinite(run["input"]) & np.isfinite(run["position"]) & np.isfinite(run["step"])
    step, u, y = (run[name][known] for name in ("step", "input", "position"))
    starts = np.flatnonzero(np.concatenate([[True], np.diff(step) != 0])) if step.size else np.array([], int)
    curves: list[ForcCurve] = []
    saturation: tuple[float, float] | None = None
    for begin, end in zip(starts, [*starts[1:], step.size]):
        if step[begin] == CALIBRATION:
            saturation = (-float(u[end - 1]), -float(y[end - 1]))
        else:
            curve = _curve(run, int(step[begin]), -u[begin:end], -y[begin:end])
            curves.append(replace(curve, saturation=saturation))
    if not curves:
        raise DataError(f"{run.path} has no curves: every reading is a calibration point or not a number.")
    return tuple(curves)


def _curve(run: Run, number: int, beta: Array, y: Array) -> ForcCurve:
    begin = int(np.argmax(beta))
    beta, y = beta[begin:], y[begin:]
    least_before = np.concatenate([[np.inf], np.minimum.accumulate(beta)[:-1]])
    onward = beta < least_before
    back = int(np.sum(~onward))
    if back > _MAX_REVERSED_SHARE * beta.size:
        raise DataError(
            f"{run.path}, curve {number}: the field turns back at {back} of {beta.size} points after the "
            "reversal, but a first-order curve rises from its reversal field."
        )
    return ForcCurve(float(beta[0]), beta[onward], y[onward])
