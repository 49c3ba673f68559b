"""A shunt that reads low, on the firmware under simavr in real time: the wire stays below its limit and 10 K.

Part of .ci/long, for a machine that keeps real time.
"""

import pytest

from rig.bench.wired_chips import Chips
from smarig.config import load_rig
from smarig.core import RigFault
from smarig.plant import Actuator
from smarig.rig import Specimen, TwinSettings
from smarig.runner import Session

pytestmark = pytest.mark.long("real time on chips")


class LowShuntChips(Chips):
    """Chips whose amplifier drives ``factor`` times what it reads."""

    def __init__(self, folder, start, factor):
        self._factor, self.hottest_K = factor, 0.0
        super().__init__(folder, start)
        file = load_rig("one_wire_twin")
        strong = file.model_copy(
            update={"amplifier": file.amplifier.model_copy(update={"saturation_A": 10.0})}
        )
        self._specimen = Specimen(strong, Actuator.named(file.actuator), TwinSettings(seed=2))

    def _amplified(self, driven_uA):
        with self._one_at_a_time:
            r = self._specimen.advance(self._factor * driven_uA / 1e6)
            self._counts, self._ambient = r.counts, r.ambient
            self.hottest_K = max(self.hottest_K, self._specimen.plant.heating.wire_K[0])
            return f"in {round(r.current / self._factor)} {r.voltage} {r.temperature} 0"


@pytest.mark.parametrize("factor", [1.2, 1.4, 1.9])
def test_the_wire_stays_below_its_limit(factor, tmp_path, start):
    chips = LowShuntChips(tmp_path, start, factor)
    low = pytest.raises(RigFault, match=r"ohm is outside|no allowed current needs|resistance")
    with low, Session(str(chips.rig)) as session:
        session.run("validation", {"points": "3"}, tmp_path / "low.run.sqlite")
    chips.wait()
    assert 0 < chips.hottest_K < load_rig("one_wire_twin").limits.temperature_max_K + 10.0
    assert chips.driven()[-1] == 0
