"""The format of the fault table: faults, phases, links, and the ending of each cell. The rows are in
fault_rows.py.

``test_fault_table.py`` tests every cell; ``fault_page.py`` prints the table into docs/reference/faults.md.
In a sentence, … stands for varying text such as ports and numbers, and | separates two alternatives.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

PHASES = ("opening", "started", "in a hold", "step change", "zeroing", "end")
LINKS = ("serial", "modbus_tcp", "modbus_rtu")
RELAYED = ("socket", "rfc2217")  # lines again, through pyserial's network ports
AMPLIFIER, ENCODER = "amplifier", "encoder_daq"


class Outcome(NamedTuple):
    """Exit status, and the sentence on stderr ("" for none: the run is done)."""

    status: int
    reads: str

    def matches(self, sentence: str) -> bool:
        """Whether that is this outcome's sentence."""
        known = (".*".join(map(re.escape, one.split("…"))) for one in self.reads.split("|"))
        return any(re.fullmatch(one, sentence) for one in known)


DONE = Outcome(0, "")


@dataclass(frozen=True)
class Fault:
    """One row. ``simulated``: faults of simulators/faults.py without their beginning; ``host``: see hurt_host.py;
    ``wiring``: see wiring.py. ``phases``: where it ends otherwise than in ``outcome``; None for no such cell.
    """

    name: str
    device_does: str
    host_does: str
    outcome: Outcome
    simulated: tuple[dict, ...] = ()
    host: str = ""
    wiring: str = ""
    lasts_s: float | None = None  # of device time
    by_time: bool = False  # begins with a tick, not with a request
    real_time: bool = False
    by_bytes: bool = False  # not on Modbus TCP, which has checks of its own
    loses_control: bool = False  # of the current: 0 A counts from the fault on, not from when it is noticed
    same_data: bool = False  # the run continues and holds the data of a run without faults
    retries: bool = False  # the samples that took several attempts are reported
    usual: str = "in a hold"  # the phase that is tried in everyday CI
    phases: dict[str, Outcome | None] = field(default_factory=dict)
    maybe_done: tuple[str, ...] = ()  # phases in which the run may be over before it is noticed

    def at(self, phase: str) -> Outcome | None:
        """How it ends in a phase."""
        return self.phases.get(phase, self.outcome)


class Cell(NamedTuple):
    """One fault in one phase on one link."""

    fault: Fault
    phase: str
    link: str

    @property
    def name(self) -> str:
        """For people and pytest."""
        return f"{self.fault.name}, {self.phase}, {self.link}"

    @property
    def outcomes(self) -> tuple[Outcome, ...]:
        """One of these."""
        outcome = self.fault.at(self.phase)
        also = (DONE,) if self.phase in self.fault.maybe_done else ()
        return (outcome, *also) if outcome else also


def cells(faults: Sequence[Fault]) -> Iterator[Cell]:
    """The whole product, as far as there are such cells."""
    for fault in faults:
        for phase in PHASES:
            for link in LINKS:
                if fault.at(phase) is not None and not (fault.by_bytes and link == "modbus_tcp"):
                    yield Cell(fault, phase, link)


def everyday(faults: Sequence[Fault], representative: Sequence[str]) -> Iterator[Cell]:
    """Every fault once, the representative ones on another link each, the last of them on all.

    Those of real time are for a machine that keeps it: ``whole``.
    """
    others = dict(zip(representative, LINKS[1:]))
    for fault in faults:
        if fault.real_time:
            continue
        yield Cell(fault, fault.usual, LINKS[0])
        if fault.name in others:
            yield Cell(fault, fault.usual, others[fault.name])
        elif fault.name in representative:
            yield from (Cell(fault, fault.usual, link) for link in LINKS[1:])


def relayed(faults: Sequence[Fault], representative: Sequence[str]) -> Iterator[Cell]:
    """The representative faults through pyserial's network ports."""
    for fault in faults:
        if fault.name in representative:
            yield from (Cell(fault, fault.usual, link) for link in RELAYED)


def whole(faults: Sequence[Fault], representative: Sequence[str]) -> Iterator[Cell]:
    """All that there is to try."""
    yield from cells(faults)
    yield from relayed(faults, representative)
