"""Mutated files of every format, each opened in a child with limits of time and memory.

python -m mutated.campaign [FORMAT ...] [--count 10000] [--from 0]: prints a row for each format, and each internal
error once per place in the code. A mutation is its number: ``--count 1 --from 4711`` repeats one.
"""

import argparse
import json
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from mutated import forked_child
from mutated.formats import FORMATS, Format
from smarig.core import SmarigError
from smarig.exchange.binary import hdf5_process

HEADER = (
    "| format | mutations | read | refused | internal errors | longest s | peak MB | longest sentence |\n"
    "|---|---|---|---|---|---|---|---|"
)
ROUND = 1000  # of each format before the next; a table after each round
CPU_S = 20  # a file that takes longer hangs,
WAIT_S = 600  # so does one that waits longer, on however busy a machine
MEMORY_BYTES = 4_000_000_000


@dataclass
class Score:
    """What became of the mutations of a format; ``internal``: by place, with the first number."""

    format: str
    count: int = 0
    read: int = 0
    refused: int = 0
    internal: Counter[str] = field(default_factory=Counter)
    first: dict[str, int] = field(default_factory=dict)
    longest_s: float = 0.0
    peak_MB: float = 0.0
    sentence: int = 0  # characters of the longest refusal

    def row(self) -> str:
        """A row of the table."""
        return (
            f"| {self.format} | {self.count} | {self.read} | {self.refused} | {self.internal.total()} | "
            f"{self.longest_s:.2f} | {self.peak_MB:.0f} | {self.sentence} |"
        )


def open_one(form: Format, path: Path) -> str:
    """ "" if the file was read, the sentence if it was refused. Anything else is raised."""
    try:
        form.open(path)
    except SmarigError as error:
        return str(error) or "refused without a sentence"
    return ""


def run_format(form: Format, folder: Path, numbers: range, score: Score) -> None:
    """Mutations of a format."""
    seeds = form.seeds(folder / "honest")
    number = numbers.start
    while number < numbers.stop:
        number = _batch(form, seeds, folder, range(number, numbers.stop), score)


def _batch(form: Format, seeds: list[bytes], folder: Path, numbers: range, score: Score) -> int:
    """Mutations in one child until it ends; returns the next number."""
    ask, tell = os.pipe()
    child = os.fork()
    if not child:
        os.close(ask)
        try:
            _child(form, seeds, folder, numbers, tell)
        finally:
            os._exit(1)  # a mistake of the campaign itself
    os.close(tell)
    done, began = numbers.start, time.monotonic()
    with os.fdopen(ask) as lines:
        signal.signal(signal.SIGALRM, lambda *_: os.kill(child, signal.SIGKILL))
        for line in lines:
            signal.alarm(WAIT_S)
            said = json.loads(line)
            _count(score, done, said)
            done, began = done + 1, time.monotonic()
        signal.alarm(0)
    _, status, _ = os.wait4(child, 0)
    code = os.waitstatus_to_exitcode(status)
    if code:
        _count(score, done, {"internal": f"ended by {signal.Signals(-code).name if code < 0 else code}"})
        score.longest_s = max(score.longest_s, time.monotonic() - began)
        done += 1
    return done


def _count(score: Score, number: int, said: dict) -> None:
    score.count += 1
    score.longest_s = max(score.longest_s, said.get("s", 0.0))
    score.peak_MB = max(score.peak_MB, said.get("MB", 0.0))
    if place := said.get("internal"):
        score.internal[place] += 1
        score.first.setdefault(place, number)
    elif said["refused"]:
        score.refused += 1
        score.sentence = max(score.sentence, len(said["refused"]))
    else:
        score.read += 1


def _child(form: Format, seeds: list[bytes], folder: Path, numbers: range, tell: int) -> None:
    """Never returns. A line after each file; the limit of time starts anew with each."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    warnings.simplefilter("ignore")
    hdf5_process.started = forked_child.started
    path = folder / f"mutated{form.ending}"
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    for number in numbers:
        content = form.mutation(seeds, number)
        path.unlink(missing_ok=True)
        path.write_bytes(content)
        usage = resource.getrusage(resource.RUSAGE_SELF)
        used_s = usage.ru_utime + usage.ru_stime
        resource.setrlimit(resource.RLIMIT_CPU, (int(used_s) + CPU_S, resource.RLIM_INFINITY))
        said: dict[str, object] = {}
        began = time.perf_counter()
        try:
            said["refused"] = open_one(form, path)
        except BaseException as error:
            frames = traceback.extract_tb(error.__traceback__)
            own = [f for f in frames if "smarig" in f.filename] or list(frames)
            place = f"{Path(own[-1].filename).name}:{own[-1].lineno} {type(error).__name__}"
            said["internal"] = f"{place}: {str(error)[:100]}" if "--count=1" in sys.argv else place
        said["s"] = time.perf_counter() - began
        said["MB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
        os.write(tell, (json.dumps(said) + "\n").encode())
    os._exit(0)


def main() -> int:
    """The campaign; returns 1 if there was an internal error."""
    words = argparse.ArgumentParser()
    words.add_argument("formats", nargs="*", default=list(FORMATS))
    words.add_argument("--count", type=int, default=10_000)
    words.add_argument("--from", type=int, default=0, dest="first")
    given = words.parse_args()
    scores = {name: Score(name) for name in given.formats}
    end = given.first + given.count
    with tempfile.TemporaryDirectory(prefix="smarig-mutated-") as name:
        os.environ |= {"SMARIG_LOCK_DIR": f"{name}/locks", "SMARIG_HISTORY_DIR": f"{name}/wires"}
        for begin in range(given.first, end, ROUND):
            for form, score in scores.items():
                run_format(FORMATS[form], Path(name), range(begin, min(begin + ROUND, end)), score)
            print(HEADER, *(score.row() for score in scores.values()), sep="\n", flush=True)
    for score in scores.values():
        for place, times in score.internal.most_common():
            print(f"{score.format}: {times} × {place}, first {score.first[place]}")
    return int(any(score.internal for score in scores.values()))


if __name__ == "__main__":
    sys.exit(main())
