"""Every fault at every call of a run file's life, or a sample of them; prints what came of it as JSON.

Run in a process that was started with the faulty disk: ``python -m record.faults.campaign FOLDER SHARE [KIND…]``.
"""

import collections
import contextlib
import json
import os
import random
import shutil
import sys
import tempfile
import traceback
from collections.abc import Iterator
from pathlib import Path

from record.faults.judge import Promises, judged
from record.faults.kinds import CUTS, KILLS, LIVE, NONE, READ_ONLY, THEN_CUT, disk
from record.faults.life import hurry, live
from record.faults.power_cut import NOTE, OPEN, TRUNCATE, WRITE, Call, Disk, calls
from record.runs import sample
from smarig.core import SmarigError
from smarig.record import Continuation, Recorder, load_run

NAME = "a.run.sqlite"
WRITES_ONLY = ("a short write", "a short write, then a full disk", "killed half way through a write")
SPACE_ONLY = ("one refusal for lack of space",)


@contextlib.contextmanager
def armed(folder: Path, at: int, kind: int, log: int = -1) -> Iterator[None]:
    """The disk as it fails."""
    disk().fault_arm(str(folder).encode(), at, kind, log)
    try:
        yield
    finally:
        disk().fault_disarm()


def lived(folder: Path, at: int, kind: int, log: int = -1) -> list[list]:
    """What a life tells whose disk fails so; it is a process of its own."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)

        def tell(*told: object) -> None:
            text = json.dumps(told).encode()
            disk().fault_note(text)
            os.write(writing, text + b"\n")

        try:
            with armed(folder, at, kind, log):
                live(folder / NAME, tell)
        except BaseException:
            tell("crashed", traceback.format_exc())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as lines:
        told = [json.loads(line) for line in lines]
    os.waitpid(child, 0)
    return told


def found_wrong(folder: Path, told: list[list], resume: bool) -> list[str]:
    """What is wrong with what is left in a folder; first read where nothing can be written."""
    promises = Promises()
    for one in told:
        promises.hear(one)
    wrong = [f"crashed: {one[1]}" for one in told if one[0] == "crashed"]
    path = folder / NAME
    with armed(folder, 0, READ_ONLY):
        wrong += [f"{text} (read-only)" for text in judged(path, promises)]
    wrong += judged(path, promises)
    if resume and not wrong and path.exists():
        with armed(folder, 0, NONE):  # syncs cost no time
            wrong += goes_on(path)
    return wrong


def goes_on(path: Path) -> list[str]:
    """What goes wrong when such a run is resumed and closed."""
    try:
        before = load_run(path)
        own = Recorder(path, {}, continuation=Continuation())
        own.sample(sample(500_000), None, 0.0)
        own.close()
        after = load_run(path)
    except SmarigError as error:
        return [f"unreadable: resumed: {error}"]
    whole = after.complete and len(after) == len(before) + 1 and len(after.steps) == len(before.steps)
    return (
        [] if whole and [p.name for p in path.parent.glob(f"{NAME}*")] == [NAME] else ["lost: when resumed"]
    )


def reference(folder: Path, logs: Path) -> tuple[list[Call], int]:
    """The calls of a life without faults, and their number."""
    with (logs / "log").open("wb") as log:
        told = lived(folder, 0, NONE, log.fileno())
    assert [one[0] for one in told].count("closed") == 2, told
    assert not found_wrong(folder, told, resume=True)
    found = calls((logs / "log").read_bytes())
    return found, found[-1].number


def jobs(found: list[Call], count: int) -> list[tuple[str, int]]:
    """Every kind at every call that it applies to."""
    kinds = {call.number: call.kind for call in found if call.kind != NOTE}
    every = [(kind, at) for kind in (*LIVE, *THEN_CUT, *CUTS) for at in range(1, count + 1)]
    growing = (OPEN, WRITE, TRUNCATE)
    return [
        (kind, at)
        for kind, at in every
        if not (kind in WRITES_ONLY and kinds.get(at) != WRITE)
        and not (kind in SPACE_ONLY and kinds.get(at) not in growing)
        and not (kind in CUTS and at not in kinds)
    ]


def cut(found: list[Call], at: int, how: str, home: Path, chance: random.Random) -> list[list]:
    """Fill an empty folder with what a cut after a call leaves; returns what had been told until then."""
    left, told = Disk(home), []
    for call in found:
        if call.number > at:
            break
        if call.kind == NOTE:
            told.append(json.loads(call.one))
        else:
            left.apply(call)
    left.leave(home, how, chance)
    return told


def cut_after_fault(at: int, kind: int, home: Path, logs: Path, chance: random.Random) -> list[list]:
    """The same after a whole life with a fault."""
    with (logs / "log").open("wb") as log:
        told = lived(home, at, kind, log.fileno())
    shutil.rmtree(home)
    home.mkdir()
    found = calls((logs / "log").read_bytes())
    cut(found, found[-1].number, CUTS[0], home, chance)
    return told


def phase(found: list[Call], at: int) -> str:
    """Whether a call belongs to the creation, to a closing, or lies between."""
    notes = [json.loads(c.one)[0] for c in found if c.kind == NOTE and c.number < at]
    coming = [json.loads(c.one)[0] for c in found if c.kind == NOTE and c.number >= at]
    if "created" not in notes:
        return "creation"
    return "closing" if coming[:1] == ["closed"] else "between"


def main(folder: Path, share: float, only: list[str]) -> None:
    """Run the share of all jobs of these kinds (all kinds by default), and print the result."""
    hurry()
    chance = random.Random(20)
    home, logs = folder / "home", folder / "logs"
    for place in (home, logs):
        place.mkdir(parents=True)
    tempfile.tempdir = str(logs)
    found, count = reference(home, logs)
    chosen = [job for job in jobs(found, count) if not only or job[0] in only]
    if share < 1:
        chosen = chance.sample(chosen, round(share * len(chosen)))
    wrong, done, deaths = [], collections.Counter(), collections.Counter()
    for number, (kind, at) in enumerate(chosen):
        shutil.rmtree(home)
        home.mkdir()
        if kind in CUTS:
            told = cut(found, at, kind, home, chance)
        elif kind in THEN_CUT:
            told = cut_after_fault(at, THEN_CUT[kind], home, logs, chance)
        else:
            told = lived(home, at, LIVE[kind])
        wrong += [f"{kind}, call {at}: {text}" for text in found_wrong(home, told, resume=number % 4 == 0)]
        done[kind] += 1
        if kind in KILLS:
            deaths[phase(found, at)] += 1
    print(
        json.dumps(
            {"calls": count, "injections": done.total(), "by_kind": done, "kills": deaths, "wrong": wrong}
        )
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]), sys.argv[3:])
