"""Compares a run file with what was promised of it: nothing lost, nothing untrue, and it opens."""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from record.runs import sample
from smarig.core import SmarigError
from smarig.record import Run, load_run


@dataclass
class Promises:
    """What a life has told."""

    created: bool = False
    given: set[int] = field(default_factory=set)
    stored: set[int] = field(default_factory=set)
    steps: set[int] = field(default_factory=set)
    given_steps: set[int] = field(default_factory=set)
    closed: bool = False  # and not resumed since
    before: int = 0  # steps before it was resumed
    said: str = ""  # the last message, if none succeeded since

    def hear(self, told: list[Any]) -> None:
        """One more thing told."""
        kind, *rest = told
        if kind == "created":
            self.created = True
        elif kind == "given":
            self.given |= set(rest[0])
            self.given_steps |= set(rest[1])
        elif kind == "stored":
            self.stored |= set(rest[0])
            self.steps |= set(rest[1])
        elif kind == "closed":
            self.closed, self.said = True, ""
        elif kind == "resuming":
            self.closed, self.before = False, len(self.steps)
        elif kind == "said":
            self.said = rest[0]


def judged(path: Path, promises: Promises) -> list[str]:
    """What is wrong with a file, in words; each starts with "lost", "untrue" or "unreadable"."""
    if not path.exists():
        return ["unreadable: there is no file"] if promises.created else []
    try:
        run = load_run(path)
    except SmarigError as error:
        return [f"unreadable: {error}"]
    wrong = [f"lost: tick {t}" for t in sorted(promises.stored - set(run["tick"].astype(int)))]
    wrong += [f"lost: step {n}" for n in sorted(promises.steps - {s.index for s in run.steps})]
    wrong += _wrong_values(run)
    return wrong + list(_untrue(run, promises))


def _wrong_values(run: Run) -> list[str]:
    if not len(run):
        return []
    ticks = run["tick"].astype(int)
    right = (run["counts"] == 7 * ticks) & (run["position"] == [sample(int(t)).position for t in ticks])
    return [f"lost: the value of tick {t}" for t in ticks[~right]]


def _untrue(run: Run, promises: Promises):
    whole = promises.given <= set(run["tick"].astype(int))
    if promises.closed and not (run.complete and whole):
        yield "untrue: closed"
    said = promises.said
    held = re.search(
        r"It holds at least (no new samples|the samples up to ([\d.]+) s) and (\d+) of (\d+) steps", said
    )
    if held:
        last_s = run["t_s"][-1] if len(run) else -1.0
        if held[2] and last_s < float(held[2]) - 0.051:  # rounded
            yield f"untrue: {held[0]}"
        if len(run.steps) - promises.before < int(held[3]):
            yield f"untrue: {held[0]}"
    if "All other samples are recorded" in said and not whole:
        yield "untrue: all others are recorded"
    if re.search("The end of run .* is stored", said) and not (run.complete and whole):
        yield f"untrue: {said}"
