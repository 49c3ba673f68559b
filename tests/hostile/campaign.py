"""Every hostile file before every command, each in a process of its own with limits of time and memory.

python -m hostile.campaign [WORD]: only the cases that contain a word. Prints what is wrong, and counts.
"""

import contextlib
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from hostile.hostile_files import COMMANDS, Case, cases
from hostile.judgement import objections
from hostile.material import Material, make_material

CPU_S = 5  # a command that takes longer hangs,
LONGER_S = {"diagnose": 60, "check": 30}  # except where it computes as long for honest files of this size
WAIT_S = 300  # so does one that waits longer, with or without computing
MEMORY_BYTES = 3_000_000_000
MOST_MB = 1200  # 400 of them are the imported packages


@dataclass(frozen=True)
class Outcome:
    """How a case ended: exit status, seconds of computing, largest memory, and what is wrong."""

    case: Case
    status: int
    cpu_s: float
    memory_MB: float
    wrong: list[str]


def carry_out(case: Case, m: Material, work: Path) -> Outcome:
    """One case in a child of this process, which has imported everything."""
    shutil.rmtree(work, ignore_errors=True)
    out = work / "out"
    out.mkdir(parents=True)
    words = case.words(m, case.make(m, work / "in"), out)
    child = os.fork()
    if not child:
        _command(words, work, LONGER_S.get(case.command, CPU_S))
    status, usage, hangs = _wait(child)
    said, err = ((work / name).read_text(encoding="utf-8", errors="replace") for name in ("stdout", "stderr"))
    cpu_s = usage.ru_utime + usage.ru_stime
    wrong = ["hangs"] if hangs else objections(m, status, said, err, out)
    if usage.ru_maxrss > MOST_MB * 1000:
        wrong.append(f"takes {usage.ru_maxrss / 1000:.0f} MB")
    return Outcome(case, status, cpu_s, usage.ru_maxrss / 1000, wrong)


def _command(words: list[str], work: Path, cpu_s: int) -> None:
    """The child: never returns."""
    status = 99
    try:
        resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 1))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
        resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000_000, 1_000_000_000))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        for stream, name in ((0, os.devnull), (1, work / "stdout"), (2, work / "stderr")):
            os.dup2(os.open(name, os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o600), stream)
        os.chdir(work / "out")
        from smarig.cli import run

        status = run(words)
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(status)


def _wait(child: int) -> tuple[int, resource.struct_rusage, bool]:
    """Exit status (negative: a signal), use of resources, and whether it hung."""
    end = time.monotonic() + WAIT_S
    while True:
        done, status, usage = os.wait4(child, os.WNOHANG)
        if done:
            code = os.waitstatus_to_exitcode(status)
            return code, usage, code in (-signal.SIGXCPU, -signal.SIGKILL)
        if time.monotonic() > end:
            with contextlib.suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)
        time.sleep(0.002)


def import_everything(m: Material, folder: Path) -> None:
    """Each command once with honest files, in this process, so that children start at once."""
    from smarig.cli import run

    honest = {
        "run": m.killed,
        "table": m.folder / "good.csv",
        "toml": m.folder / "rig.toml",
        "model": m.model,
    }
    honest |= {"matlab": m.folder / "good.mat", "hdf5": m.folder / "good.h5", "numbers": m.killed}
    with (
        Path(os.devnull).open("w") as nowhere,
        contextlib.redirect_stdout(nowhere),
        contextlib.redirect_stderr(nowhere),
    ):
        for kind, commands in COMMANDS.items():
            for name, words in commands.items():
                if name not in ("view", "replace", "resume", "report of a folder"):
                    out = folder / f"{kind} {name}"
                    out.mkdir()
                    run([str(word) for word in words(m, honest[kind], out)])


def main(only: str = "") -> int:
    """The whole campaign; returns the number of cases in which something is wrong."""
    with tempfile.TemporaryDirectory(prefix="smarig-hostile-") as name:
        folder = Path(name)
        os.environ |= {"SMARIG_LOCK_DIR": str(folder / "locks"), "SMARIG_HISTORY_DIR": str(folder / "wires")}
        m = make_material(folder / "honest")
        (folder / "warm").mkdir()
        import_everything(m, folder / "warm")
        outcomes = []
        for case in cases():
            if only in str(case):
                outcomes.append(carry_out(case, m, folder / "work"))
                if outcomes[-1].wrong:
                    print(f"{case}: {'; '.join(outcomes[-1].wrong)}", flush=True)
    return _summary(outcomes)


def _summary(outcomes: list[Outcome]) -> int:
    wrong = [o for o in outcomes if o.wrong]
    files = {(o.case.kind, o.case.file) for o in outcomes}
    kinds = Counter(text.split(":")[0] for o in wrong for text in o.wrong)
    print(f"{len(files)} files, {len(outcomes)} cases, {len(wrong)} wrong: {dict(kinds)}")
    print(f"exit statuses: {dict(Counter(o.status for o in outcomes))}")
    for key, unit in (("cpu_s", "s of CPU"), ("memory_MB", "MB")):
        top = sorted(outcomes, key=lambda o: getattr(o, key))[-5:]
        print(f"most: {', '.join(f'{getattr(o, key):.1f} {unit} ({o.case})' for o in reversed(top))}")
    return len(wrong)


if __name__ == "__main__":
    sys.exit(1 if main(*sys.argv[1:2]) else 0)
