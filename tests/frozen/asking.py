"""Uses smarig from the outside: the command line, its JSON, and the tables of run files.

Nothing here imports the package, so internal changes do not affect these questions.
"""

import contextlib
import hashlib
import io
import json
import math
import os
import runpy
import signal
import sqlite3
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

Answer = Any  # plain values, as JSON has them
# Of a moment, a process, a machine or a version; not of the wire.
VOLATILE = frozenset(
    {"seconds", "epoch", "start_epoch", "created", "recorder_pid", "device", "versions", "config"}
    | {"hashes", "hashed"}  # of all of this; runs of an older smarig have none
    | {"sha256", "model_sha256"}  # of files that hold such a moment
)
_SAMPLE = (
    *("tick", "t_s", "step", "current_command_A", "current_A", "voltage_V", "temperature_degC"),
    *("input", "counts", "position", "ambient_degC"),
)
_STEP = ("index", "attempt", "void", "target", "t_start_s", "t_end_s", "position", "n")
_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)
)


def ask(*words: object) -> dict[str, Any]:
    """What ``python -m smarig WORDS --json`` answers, and its exit status; run in this process, which is quicker.

    A refusal is an answer; an interruption, or a fault of smarig's own, is none.
    """
    out = io.StringIO()
    with _as_main(["smarig", *map(str, words), "--json"]), contextlib.redirect_stdout(out):
        try:
            runpy.run_module("smarig", run_name="__main__")
            status = 0
        except SystemExit as leaving:
            status = leaving.code or 0
    lines = out.getvalue().splitlines()
    if status == 130:
        raise KeyboardInterrupt
    if status == 1:
        raise RuntimeError(f"smarig {' '.join(map(str, words))} ended with status {status}: {lines}")
    return {"exit_status": status} | (json.loads(lines[-1]) if lines else {})


def must(*words: object) -> dict[str, Any]:
    """The same, where anything but success is our own mistake."""
    answer = ask(*words)
    if answer["exit_status"]:
        raise RuntimeError(f"smarig {' '.join(map(str, words))}: {answer}")
    return answer


@contextlib.contextmanager
def _as_main(argv: list[str]) -> Iterator[None]:
    """As the interpreter would be at the start of a program; afterwards as it was."""
    before, handlers = sys.argv, [(number, signal.getsignal(number)) for number in _SIGNALS]
    sys.argv = argv
    try:
        with contextlib.redirect_stderr(io.StringIO()):
            yield
    finally:
        sys.argv = before
        for number, handler in handlers:
            signal.signal(number, handler)


@contextlib.contextmanager
def private(folder: Path) -> Iterator[None]:
    """Use private locks and wire histories."""
    names = {"SMARIG_LOCK_DIR": folder / "locks", "SMARIG_HISTORY_DIR": folder / "wires"}
    before = {name: os.environ.get(name) for name in names}
    for name, path in names.items():
        path.mkdir(parents=True, exist_ok=True)
        os.environ[name] = str(path)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


# --- numbers -----------------------------------------------------------------------------------------------


def digest(values: Sequence[float]) -> dict[str, Any]:
    """Many numbers in few: a hash that sees the last bit, and two means that a tolerance can be given to."""
    x = np.array([math.nan if v is None else v for v in values], dtype="<f8")
    known = x[np.isfinite(x)].tolist()
    n = max(len(known), 1)
    late = [v * k / n for k, v in enumerate(known)]  # sees their order
    return {
        "n": len(x),
        "known": len(known),
        "hash": hashlib.sha256(x.tobytes()).hexdigest(),
        "mean": math.fsum(known) / n,
        "late": math.fsum(late) / n,
    }


def thinned(values: Sequence[float], n: int = 20) -> list[float]:
    """Some of them, from the first to the last."""
    return [values[round(k)] for k in np.linspace(0, len(values) - 1, min(n, len(values)))]


def numbers_in(value: Any) -> Iterator[float]:
    """Every number of a value, however deep, by the order of the keys."""
    if isinstance(value, Mapping):
        for key in sorted(value):
            yield from numbers_in(value[key])
    elif isinstance(value, list):
        for inner in value:
            yield from numbers_in(inner)
    elif isinstance(value, int | float):
        yield value


# --- files -------------------------------------------------------------------------------------------------


def table(path: Path, *, whole: bool = False) -> dict[str, Any]:
    """Samples and steps of a run file in few numbers; ``whole``: its events and its description as well."""
    with contextlib.closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True)) as db:
        samples = list(zip(*db.execute(f"SELECT {','.join(_SAMPLE)} FROM sample ORDER BY tick")))
        numbers = ",".join(f'"{name}"' for name in _STEP)
        steps = list(zip(*db.execute(f'SELECT {numbers} FROM step ORDER BY "index", attempt')))
        words = Counter(" ".join(map(str, row)) for row in db.execute("SELECT branch, verdict FROM step"))
        rest = {"events": _events(db), "meta": _meta(db)} if whole else {}
    return {
        "sample": {name: digest(column) for name, column in zip(_SAMPLE, samples) if any_known(column)},
        "step": {name: digest(column) for name, column in zip(_STEP, steps) if any_known(column)},
        "branches": dict(words),
    } | rest


def any_known(column: Sequence[Any]) -> bool:
    """Whether a column holds anything."""
    return any(value is not None for value in column)


def positions(path: Path) -> list[float]:
    """The output in a run file."""
    with contextlib.closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True)) as db:
        return [row[0] for row in db.execute("SELECT position FROM sample ORDER BY tick")]


def _events(db: sqlite3.Connection) -> list[Any]:
    rows = db.execute("SELECT t_s, level, kind, text, data FROM event WHERE kind != 'rig' ORDER BY rowid")
    return [[t_s, level, kind, text, _short(json.loads(data))] for t_s, level, kind, text, data in rows]


def _meta(db: sqlite3.Connection) -> dict[str, Any]:
    return {key: _short(json.loads(value)) for key, value in db.execute("SELECT key, value FROM run")}


def _short(value: Any) -> Any:
    """Long lists of numbers as their digest."""
    if isinstance(value, dict):
        return {key: _short(inner) for key, inner in value.items()}
    return digest(list(numbers_in(value))) if isinstance(value, list) and len(value) > 20 else value


def model(path: Path) -> dict[str, Any]:
    """A model file, with its many numbers summarised."""
    data = json.loads(path.read_text(encoding="utf-8"))
    keys = ("schema_version", "twin", "rig", "arrangement", "input", "output", "mirrored", "effects")
    return {key: data[key] for key in (*keys, "parameters", "intervals", "noise_floor", "warnings")} | {
        "kind": data["hysteresis"]["kind"],
        "hysteresis": digest(list(numbers_in(data["hysteresis"]))),
        "covariance": digest(list(numbers_in(data["covariance"]))),
    }


def tidy(answer: Answer, folder: Path) -> Answer:
    """The answer without what is of this moment, and without the folder that it was computed in."""
    if isinstance(answer, Mapping):
        return {str(k): tidy(v, folder) for k, v in answer.items() if k not in VOLATILE}
    if isinstance(answer, list | tuple):
        return [tidy(inner, folder) for inner in answer]
    return answer.replace(f"{folder}/", "") if isinstance(answer, str) else answer
