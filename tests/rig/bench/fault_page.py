"""``PYTHONPATH=tests python tests/rig/bench/fault_page.py`` writes the fault table to docs/reference/faults.md."""

import json
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

The everyday tests try each kind of fault that does not need real time once, and these three on Modbus TCP or RTU.
`SMARIG_FAULTS=all` tries all {len(CELLS)} cells (`.ci/long`).
The lease is {LEASE_S:g} s in lock-step and {REAL_LEASE_S:g} s in real time, which runs {REAL_TIME} times as fast as the
wall clock.
In messages, … stands for varying text. "done" stands for a run that ends normally.
"""


CHANNELS = """## Faults of one channel

Measured by `smarig benchmark plausibility`, with the default `limits.model_tolerance`
(`tests/rig/bench/channel_faults.json`).
A fault begins 3 s after the start of one of ten holds, which take the wire through its whole range and back; they go
on, once more through the range, until the run ends. *Slipping to 0.7*: this share of every change arrives. *Phases*:
how many of the ten were measured, how often a sample was marked, and how often the run ended. Times are the median and
the longest. *Error until then*: the largest before the first mark. *Unseen*: the largest error of a step that was
recorded as settled without a mark. When the channel contradicts its own earlier readings, the steps that settled since
those become `suspect` in the record; they then count as not settled.

{rows}

What is not seen: a slip to 0.9, a jump of 5 counts, and on `two_wire_thermomechanical` (706 counts of stroke) one of
50: a wire within the tolerance may move so, and steps with them are recorded as settled. A wrong sign is seen at the
first motion of a twentieth of the stroke (half the tolerance) against the heat; while the wire rests, it cannot be
seen. On hardware `limits.model_tolerance` is 0.3, not 0.1, until the wire is calibrated: errors three times as large
stay unseen, and a wrong sign is seen at 0.15 to 0.2 of it. The thermometer of a rig with two wires is compared with
`temperature_max_K` only: which wire it is on is not known.

### Over a line

On simulated devices in lock-step each framing carries the same counts, so each has the same times. A fault from 80 s
on, in the second hold; seconds until the first marked sample, and until the run ended:

| fault | `one_wire_serial`, `_modbus_tcp`, `_modbus_rtu` | `two_wire_serial`, `_modbus_tcp` | by |
|---|---|---|---|
| stuck encoder | 29.8; 32.4 | 62.7; 64.9 | host |
| slipping to 0.7 | 559.9; 568.2 | 451.0; 461.1 | host |
| jumping by 50 counts | 0.1; 1.2 | 0.1; 1.0 | host |
| open wire | 0.2; 1.2 | 0.2; 1.0 | amplifier |
| shunt that reads 1.2 times low | 0.1; 1.2 | 0.1; 1.0 | host |
| thermometer reads 30 K more | 0.1; 4.8 | –; 136 | host |
| thermometer reads no more | –; 1.2 | –; 1.0 | amplifier |

The end of a run is seen with the block of samples that has it: up to 12 ticks later than on the twin.

Doubles of other instruments, in the time of the host (20 times real time, beside other programs); loops of 0.95 A, the
fault begins at 3 mm of 12.6:

| fault | LabJack T7, laser | supply and meter by VISA | NI card, laser |
|---|---|---|---|
| stuck | 6.6; 8.8 | 12 to 16; 18 to 27 | 11.0; 11.0 |
| jump of 3 mm | 3.8; 10.1 | 0.1 to 10; 14 to 20, once not within the run | 3.8; 10.1 |
| lost (0 mm) | 4.8; 7.0 | 4.5; 7.1 | 4.6; 6.8 |
| wrong sign | 1.0; 2.9 (out of range) | 5.6; 10.0 | 1.1; 3.3 |
| slipping to 0.7 | 19.3; not within 2 loops | not within 2 loops | 19.3; not within 2 loops |
| noise of 0.6 mm | 4.9; 6.9 | 2.6; 4.4 | 5.1; 6.4 |

A reading of the host has no tick of its own, so a jump there is certain later than that of a counter
(`tests/device/test_channel_faults.py` tests four of these rows).

### Sound wires

Sound wires: {tripped} of {campaigns} campaigns ended (random holds; every effect of the catalogue at its typical
strength, {samples} samples). Marked samples: {marked}.
"""
CHANNEL_FIGURES = Path(__file__).with_name("channel_faults.json")
UNITS = {"position": "counts", "current": "A", "voltage": "V", "thermometer": "K"}


def channel_table() -> str:
    """What ``smarig benchmark plausibility`` has measured."""
    figures = json.loads(CHANNEL_FIGURES.read_text(encoding="utf-8"))
    rows = [
        "| rig | channel | fault | phases: all, marked, ended | marked after, s | error until then | ended after, s "
        "| unseen |"
    ]
    rows.append("|---|---|---|---|---|---|---|---|")
    for f in figures["faults"]:
        marked, ended = (
            "; ".join(f"{x:g}" for x in f[key] or ()) or "–" for key in ("marked_s", "tripped_s")
        )
        rows.append(
            f"| {f['rig']} | {f['channel']} | {f['fault']} | {f['phases']}, {f['marked']}, {f['tripped']} "
            f"| {marked} | {f['error']:.3g} | {ended} | {f['unseen']:.3g} {UNITS[f['channel']]} |"
        )
    sound = figures["sound"]
    marked = ", ".join(f"{n} ({name})" for name, n in sound["marked"].items()) or "none"
    return CHANNELS.format(
        rows="\n".join(rows), **{**sound, "samples": f"{sound['samples']:,}", "marked": marked}
    )


def page() -> str:
    """The text of the page."""
    parts = [HEAD, *("\n".join([f"## {name}", "", *_rows(rows)]) + "\n" for name, rows in GROUPS.items())]
    return "\n".join([*parts, "\n".join(["## By phase", "", *_phases()]) + "\n", channel_table()])


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
