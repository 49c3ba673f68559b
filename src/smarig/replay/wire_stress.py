"""The stress in two antagonist wires over a run, by the function that the guard of the rig has (``AntagonistStress``).

The wires are heated by (5.1); their phases follow the transformation temperatures without stress, so the stress is an
upper bound.
"""

from dataclasses import asdict, dataclass

import numpy as np

from smarig.plant import Actuator, AntagonistStress, JouleHeating
from smarig.record import AnyRun

_COLUMNS = ("tick", "current_A")


@dataclass(frozen=True)
class StressRange:
    """Stress in MPa: with both wires cold, and the smallest and the largest over a run."""

    cold_MPa: float
    least_MPa: float
    most_MPa: float

    @property
    def change_percent(self) -> float:
        """The largest change from the stress of the cold wires."""
        return 100 * max(self.most_MPa - self.cold_MPa, self.cold_MPa - self.least_MPa) / self.cold_MPa

    def to_json(self) -> dict[str, float]:
        """As a JSON object."""
        return {
            key: round(x, 2) for key, x in (asdict(self) | {"change_percent": self.change_percent}).items()
        }


def stress_over_run(run: AnyRun, actuator: Actuator) -> StressRange | None:
    """The stress from the measured currents of a run; None for a single wire, or without ticks, currents or ambient.

    The wires start cold. The stress-strain curves are those of the thesis, for total strain 6 %.
    """
    period_s, ambient_degC = run.info.period_s, _ambient_degC(run)
    if not actuator.two_wire or not period_s or not run.has("current_A") or ambient_degC is None:
        return None
    heating, wires = JouleHeating(actuator, float(period_s)), AntagonistStress(ambient_degC)
    cold = least = most = wires.step((0.0, 0.0))
    last = None
    for block in run.blocks(_COLUMNS):
        rows = zip(block["tick"].tolist(), np.nan_to_num(block["current_A"]).tolist())
        for tick, current_A in rows:
            if last is not None and tick > last + 1:  # lost samples: the wire was heated nevertheless
                heating.tick((tick - last) * float(period_s))
                heating.step(current_A)
                heating.tick(float(period_s))
            else:
                heating.step(current_A)
            last = tick
            stress_MPa = wires.step(heating.wire_K)
            least, most = min(least, stress_MPa), max(most, stress_MPa)
    return None if last is None else StressRange(cold, least, most)


def _ambient_degC(run: AnyRun) -> float | None:
    """The ambient temperature that the guard of the rig assumes; of other runs, the mean of what was recorded."""
    assumed = run.info.rig_values.get("ambient_degC")
    if isinstance(assumed, int | float):
        return float(assumed)
    if not run.has("ambient_degC"):
        return None
    blocks = [block["ambient_degC"] for block in run.blocks(("ambient_degC",))]
    return float(np.nanmean(np.concatenate(blocks)))
