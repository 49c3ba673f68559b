"""``PYTHONPATH=tests python tests/rig/bench/fault_page.py`` writes the fault table to docs/reference/faults.md."""

from collections.abc import Iterator
from pathlib import Path

from rig.bench.broken_rig import LEASE_S, REAL_LEASE_S, REAL_TIME
from rig.bench.fault_rows import HOST, LINES, POWER, READINGS, REPRESENTATIVE, ROWS, WIRING
from rig.bench.fault_table import LINKS, PHASES, RELAYED, Fault, whole

PAGE = Path(__file__).resolve().parents[3] / "docs" / "reference" / "faults.md"
GROUPS = {"Lines": LINES, "Power": POWER, "Readings": READINGS, "Wiring": WIRING, "Host": HOST}
CELLS = {c.name for c in whole(ROWS, REPRESENTATIVE)}
HEAD = f"""# Faults of a bench and their handling

Generated from `tests/rig/bench/fault_rows.py` by `tests/rig/bench/fault_page.py`; do not edit.
`tests/rig/bench/test_fault_table.py` tests the table on simulated devices over real bytes.

A cell is one fault in one phase of a run on one link. Each cell must be *safe*:

* The wire is at 0 A within the lease and one tick after the fault. If the host keeps control, this time counts from
  its last sample.
* The run file is closed with its cause and is readable.
* Nothing hangs.
* smarig prints one message and returns an exit status, never a traceback.

Phases: {", ".join(PHASES)}.
Links: {", ".join(LINKS)}. The network ports of pyserial, {" and ".join(RELAYED)}, are tested with three faults:
{"; ".join(REPRESENTATIVE)}.

The everyday tests try each fault that does not need real time once, these three on each of the first links, and the
first of them over a socket. `SMARIG_FAULTS=all` tries all {len(CELLS)} cells (`.ci/long`).
The lease is {LEASE_S:g} s in lock-step and {REAL_LEASE_S:g} s in real time, which runs {REAL_TIME} times as fast as the
wall clock.
In messages, … stands for varying text. "done" stands for a run that ends normally.
"""


def page() -> str:
    """The text of the page."""
    parts = [HEAD, *("\n".join([f"## {name}", "", *_rows(rows)]) + "\n" for name, rows in GROUPS.items())]
    return "\n".join([*parts, "\n".join(["## By phase", "", *_phases()]) + "\n"])


def _rows(rows: tuple[Fault, ...]) -> Iterator[str]:
    yield "| fault | the device | the host | message | status |"
    yield "|---|---|---|---|---|"
    for f in rows:
        reads = f.outcome.reads.replace("|", " or: ") or "done"
        yield f"| {f.name} | {f.device_does} | {f.host_does} | {reads} | {f.outcome.status} |"


def _phases() -> Iterator[str]:
    yield "The exit status in each phase. *: the message differs, see below the table. –: no such cell. 0 or …: the"
    yield "run may end before the fault is detected."
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
