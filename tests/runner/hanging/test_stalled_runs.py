"""Whatever file operation hangs, in whatever thread, a command ends: by itself or by two Ctrl-C, at zero current, with
one sentence, and without its locks.

The disk stalls in the kernel, where no signal interrupts (``stalled_disk.c``). ``SMARIG_LONG`` hangs every operation of
a run once, under every signal.
"""

import itertools
import os
import re
import shutil
import signal
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from runner.hanging.stalled_run import Ending, Operation, clear, operations, shim, stalled_run
from smarig.record import load_run

pytestmark = pytest.mark.skipif(
    shutil.which("gcc") is None or not Path("/proc/self/task").is_dir(),
    reason="needs gcc and Linux for a disk that hangs in the kernel",
)
TWICE = (signal.SIGINT, signal.SIGINT)
SIGNALS = {"Ctrl-C twice": TWICE, "SIGTERM": (signal.SIGTERM,), "SIGHUP": (signal.SIGHUP,), "none": ()}
LONGEST_S = 10.0  # after the second Ctrl-C
HISTORY = Operation("history", "fsync", thread="other")
READING = Operation("out", "pread64", "a.run.sqlite")
START = Operation("out", "statvfs64")
AT_ONCE = 8  # cases that mostly wait


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return shim(tmp_path_factory.mktemp("shim"))


@pytest.fixture(scope="module")
def endings(library, tmp_path_factory) -> dict[tuple[Operation, str], Ending]:
    """A file operation of each kind; they hang at the same time."""
    cases = [(HISTORY, "Ctrl-C twice"), (READING, "Ctrl-C twice"), (START, "SIGTERM")]

    def ended(case: tuple[Operation, str]) -> Ending:
        base = tmp_path_factory.mktemp("stalled")
        requested_s = 2.0 if case[0] == START else 15.0
        return stalled_run(base / "b", library, case[0], SIGNALS[case[1]], requested_s=requested_s)

    with ThreadPoolExecutor(len(cases)) as pool:
        return dict(zip(cases, pool.map(ended, cases), strict=True))


def faults(ending: Ending) -> list[str]:
    """What is wrong with an ending."""
    words = [line for line in ending.stderr.splitlines() if line.startswith("smarig:")]
    wrong = {
        "no call hung": not ending.hung,
        f"alive {LONGEST_S:g} s after the last signal": ending.after_s > LONGEST_S,
        f"locked: {ending.locked}": bool(ending.locked),
        f"{ending.output_A:g} A": ending.output_A != 0.0,
        f"ended with {ending.status}": ending.status not in (0, 4, 130),
        f"{len(words)} sentences": len(words) > 1 or (ending.status != 0 and not words),
        "traceback": "Traceback" in ending.stderr or "Internal error" in ending.stderr,
    }
    return [what for what, so in wrong.items() if so]


def test_a_stalled_disk_ends_no_command_wrongly(endings):
    assert {case: found for case, ending in endings.items() if (found := faults(ending))} == {}


def test_a_stalled_history_does_not_keep_the_run_from_being_closed(endings):
    ending = endings[HISTORY, "Ctrl-C twice"]
    assert (ending.hung, ending.status) == ("other", 0)
    assert "The wire's history was not written" in ending.stderr


def test_two_ctrl_c_end_a_main_thread_that_the_kernel_holds(endings):
    ending = endings[READING, "Ctrl-C twice"]
    assert (ending.hung, ending.status) == ("main", 130)
    assert re.search(
        r"Ctrl-C was pressed twice.*a disk .* does not answer \(.*a\.run\.sqlite\)", ending.stderr
    )


def test_sigterm_ends_a_main_thread_that_does_not_move(endings):
    ending = endings[START, "SIGTERM"]
    assert (ending.hung, ending.status) == ("main", 130)
    assert "has not moved for 2 s" in ending.stderr
    assert "The current is at zero." in ending.stderr


@pytest.mark.long("hangs every file operation of a run once, under every signal: an hour")
def test_every_operation_under_every_signal(library, tmp_path):
    """SMARIG_HANGS: 1 of so many cases (default: all). Each prints its line when it ends."""
    every = int(os.environ.get("SMARIG_HANGS", "1"))
    first = stalled_run(tmp_path / "b", library, None, ())
    assert first.status == 0
    hangs = operations(first.calls, tmp_path / "b")
    cases = list(itertools.product(hangs, SIGNALS))[::every]

    def ended(number: int) -> tuple[Ending, list[str]]:
        operation, name = cases[number]
        base = tmp_path / f"case{number}" / "b"
        ending = stalled_run(base, library, operation, SIGNALS[name], stalled_s=20.0)
        found = faults(ending) if name == "Ctrl-C twice" else [f for f in faults(ending) if "alive" not in f]
        found += ["alive"] if ending.status is None else []
        out = base / "out" / "a.run.sqlite"
        if ending.status == 0 and not load_run(out).complete:
            found.append("done, but not closed")
        clear(base.parent)
        if not ending.hung:  # a call that not every run makes, or a file that has another name each time
            found = []
        print(f"{operation}, {name}: {ending.status} after {ending.after_s:.1f} s {found or ''}", flush=True)
        return ending, found

    with ThreadPoolExecutor(AT_ONCE) as pool:
        results = list(pool.map(ended, range(len(cases))))
    wrong = {f"{cases[k][0]}, {cases[k][1]}": found for k, (_, found) in enumerate(results) if found}
    for name in SIGNALS:
        mine = [e for (_, n), (e, _) in zip(cases, results, strict=True) if n == name and e.hung]
        alive = sum(ending.after_s > LONGEST_S for ending in mine)
        print(
            f"{name}: {len(mine)} hangs, status {dict(Counter(e.status for e in mine))}, "
            f"alive 10 s after: {alive}, slowest {max((e.after_s for e in mine), default=0):.1f} s"
        )
    print(*(f"{case}: {found}" for case, found in wrong.items()), sep="\n")
    assert wrong == {}
