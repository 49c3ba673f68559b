"""The contract of instruments on the firmware under emulators, over its serial line; time is counted in its ticks."""

import time

import pytest

from rig.bench.wired_chips import Chips
from smarig.config import load_rig
from smarig.device import ContractCase, check_contract
from smarig.rig.driver_check import in_role

pytestmark = pytest.mark.long("real time on chips")
PATIENCE_S = 60.0
TIMEOUT_S = 5.0  # of a reply: a busy machine takes its time


class Displaced(Chips):
    """Chips whose encoder has counted before, so that zero changes its position."""

    def _counted(self, _):
        with self._one_at_a_time:
            return f"in {self._counts + 1000} {self._ambient} 0"


@pytest.mark.parametrize("role", ["amplifier", "encoder_daq"])
def test_the_contract(role, start, tmp_path):
    chips = Displaced(tmp_path, start, timeout_s=TIMEOUT_S)
    rig = load_rig(str(chips.rig))
    link = getattr(rig.links, role)
    absent = link.model_copy(update={"url": "/dev/no_such_port"})

    def wait(seconds):
        last, end_s = chips.ticks(role) + round(seconds / chips.period_s), time.monotonic() + PATIENCE_S
        while chips.ticks(role) < last:
            assert time.monotonic() < end_s
            time.sleep(0.001)

    case = ContractCase(lambda: in_role(role, link, rig), lambda: in_role(role, absent, rig), rig, wait)
    results = list(check_contract(role, case))
    assert results
    assert not [f"{r.name}: {r.observed}" for r in results if not r.passed or r.limitation]
