"""Prints the fault table: ``PYTHONPATH=tests python tests/rig/bench/fault_page.py`` writes docs/reference/faults.md."""

from collections.abc import Iterator
from pathlib import Path

from rig.bench.broken_rig import LEASE_S, REAL_LEASE_S, REAL_TIME
from rig.bench.fault_rows import HOST, LINES, POWER, READINGS, REPRESENTATIVE, ROWS, WIRING
from rig.bench.fault_table import LINKS, PHASES, RELAYED, Fault, whole

PAGE = Path(__file__).resolve().parents[3] / "docs" / "reference" / "faults.md"
GROUPS = {"Lines": LINES, "Power": POWER, "Readings": READINGS, "Wiring": WIRING, "Host": HOST}
CELLS = {c.name for c in whole(ROWS, REPRESENTATIVE)}
HEAD = f"""# What goes wrong on a bench, and what happens then

Generated from `tests/rig/bench/fault_rows.py` by `tests/rig/bench/fault_page.py`; do not edit.
`tests/rig/bench/test_fault_table.py` tests it on simulated devices over real bytes.

A cell is one fault in one phase of a run on one link. Each must be *safe*: the wire is at 0 A within the lease and one
tick of the fault (or, where the host keeps control, of its last sample), the run file is closed with its cause and can
be read, nothing hangs, and the person reads one sentence and an exit status, never a traceback.

Phases: {", ".join(PHASES)}.
Links: {", ".join(LINKS)}; {" and ".join(RELAYED)}, which are pyserial's network ports, with three faults:
{"; ".join(REPRESENTATIVE)}.

`tests/` tries every fault once that does not need real time, these three on each of the first links, and the first of
them over a socket; `SMARIG_FAULTS=all` tries all {len(CELLS)} cells (`.ci/long`).
Lease: {LEASE_S:g} s in lock-step; {REAL_LEASE_S:g} s where time passes by itself, {REAL_TIME} times as fast as by the
wall clock.
… stands for what differs; "done" for a run that ends well.
"""


def page() -> str:
    """The whole page."""
    parts = [HEAD, *("\n".join([f"## {name}", "", *_rows(rows)]) + "\n" for name, rows in GROUPS.items())]
    return "\n".join([*parts, "\n".join(["## By phase", "", *_phases()]) + "\n"])


def _rows(rows: tuple[Fault, ...]) -> Iterator[str]:
    yield "| fault | the device | the host | the person reads | status |"
    yield "|---|---|---|---|---|"
    for f in rows:
        reads = f.outcome.reads.replace("|", " or: ") or "done"
        yield f"| {f.name} | {f.device_does} | {f.host_does} | {reads} | {f.outcome.status} |"


def _phases() -> Iterator[str]:
    yield "The exit status in each phase. *: a sentence of its own, below. –: no such cell. 0 or …: the run may be over"
    yield "before it is noticed."
    yield ""
    yield f"| fault | {' | '.join(PHASES)} |"
    yield "|---|" + "---|" * len(PHASES)
    own: list[str] = []
    for f in ROWS:
        yield f"| {f.name} | {' | '.join(_status(f, phase, own) for phase in PHASES)} |"
    yield ""
    yield from own


def _status(f: Fault, phase: str, own: list[str]) -> str:
    outcome = f.at(phase)
    if outcome is None:
        return "–"
    status = f"0 or {outcome.status}" if phase in f.maybe_done else str(outcome.status)
    if not outcome.reads or outcome == f.outcome:
        return status
    own.append(f"* {f.name}, {phase}: {outcome.reads}")
    return f"{status}*"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
