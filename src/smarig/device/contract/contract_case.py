"""What a check of the contract is given: how to open the instrument, its rig file, how to wait, and how it reports."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any, NamedTuple

from smarig.config import RigFile
from smarig.core import SmarigError

TEST_SHARE = 0.1  # of the largest current: it heats the wire by 1 % of what the largest does
TOLERANCE_SHARE = 0.05  # of the largest current, as in the bring-up of a rig
GAIN_TOLERANCE = (
    0.15  # of the difference of two currents; a DAC of 10 bits resolves a tenth of the largest no better
)
SETTLE_TICKS = 4  # for an order to take effect and be measured


class Broken(Exception):
    """A requirement is not met; the text says what was observed."""


class Unusable(Broken):
    """A requirement is not met without which no other can be tested."""


class Check(NamedTuple):
    """The result of one check: its name, whether it is passed, what was observed.

    ``limitation``: passed, but the device lacks something that the user must make up for.
    """

    name: str
    passed: bool
    observed: str
    limitation: bool = False

    @property
    def line(self) -> str:
        """The check as a line of progress."""
        mark = "NOT" if not self.passed else "!! " if self.limitation else "ok "
        return f"{mark} {self.name}: {self.observed}"

    def to_json(self) -> dict[str, Any]:
        """The check as ``smarig check --json`` reports it."""
        return {
            "name": self.name,
            "passed": self.passed,
            "seen": self.observed,
            "limitation": self.limitation,
        }


class Limitation(str):
    """What was observed where a requirement is met, but the device lacks something."""


@dataclass(frozen=True)
class ContractCase:
    """``open`` opens the instrument in its role, ``open_absent`` at an address where there is none.

    ``wait`` lets this many seconds of the devices pass, or more on a busy machine; ``clock`` tells their seconds.
    """

    open: Callable[[], Any]
    open_absent: Callable[[], Any]
    rig: RigFile
    wait: Callable[[float], None] = time.sleep
    clock: Callable[[], float] | None = None

    @property
    def largest_A(self) -> float:
        """The largest current of the rig."""
        return max(self.rig.limits.current_max_A, -self.rig.limits.current_min_A)

    @property
    def test_A(self) -> float:
        """The current of the checks."""
        return TEST_SHARE * self.largest_A

    @property
    def tolerance_A(self) -> float:
        """The largest difference between an ordered and a measured current."""
        return TOLERANCE_SHARE * self.largest_A

    def wait_ticks(self, ticks: float) -> float:
        """Let this many ticks pass, and return how many periods have passed."""
        begin_s = self.now_s()
        self.wait(ticks * self.rig.period_s)
        return (self.now_s() - begin_s) / self.rig.period_s if self.clock else ticks

    def now_s(self) -> float:
        """The time of the devices; always 0 without a clock."""
        return self.clock() if self.clock else 0.0

    @contextmanager
    def opened(self) -> Iterator[Any]:
        """The instrument, switched off if it has an output, and closed afterwards."""
        instrument = self.open()
        try:
            yield instrument
        finally:
            for name in ("off", "close"):  # requirements of their own tell whether these raise
                with suppress(Exception):
                    getattr(instrument, name, lambda: None)()


Requirement = Callable[[ContractCase], str]  # returns what was observed; raises Broken


def results(case: ContractCase, requirements: dict[str, Requirement]) -> Iterator[Check]:
    """Every requirement in order, up to one that makes the others untestable; an error of the driver is a broken
    requirement, not the end.
    """
    for name, requirement in requirements.items():
        try:
            observed = requirement(case)
            yield Check(name, True, observed, isinstance(observed, Limitation))
        except Broken as broken:
            yield Check(name, False, str(broken))
            if isinstance(broken, Unusable):
                return
        except SmarigError as error:
            yield Check(name, False, f"it raised: {error}")
        except (Exception, SystemExit) as error:
            yield Check(name, False, f"it raised {type(error).__name__}: {error}")


def require(met: bool, text: str) -> None:
    """Raise Broken with the text unless the condition is met."""
    if not met:
        raise Broken(text)
