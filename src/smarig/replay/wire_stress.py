"""The stress in two antagonist wires over a run: heating (5.1), phases of both, force balance of thesis §5.5.1."""

from dataclasses import asdict, dataclass

import numpy as np

from smarig.plant import Actuator, JouleHeating, WirePhases, stress_of_phases_MPa
from smarig.preisach import Everett
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


def stress_over_run(run: AnyRun, actuator: Actuator, hysteresis: Everett) -> StressRange | None:
    """The stress from the measured currents of a run; None for a single wire, or without ticks and currents.

    The wires start cold. The stress-strain curves are those of the thesis, for total strain 6 %.
    """
    period_s = run.info.period_s
    if not actuator.two_wire or not period_s or not run.has("current_A"):
        return None
    heating, phases = JouleHeating(actuator, float(period_s)), WirePhases(hysteresis)
    least = most = last = None
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
            phases.step(heating.wire_K)
            austenite = phases.austenite[0] + phases.austenite[1]
            least = austenite if least is None else min(least, austenite)
            most = austenite if most is None else max(most, austenite)
    if least is None or most is None:
        return None
    ends = [stress_of_phases_MPa(x) for x in (least, most)]
    return StressRange(stress_of_phases_MPa(0.0), min(ends), max(ends))
