"""The diagnosis of records with a measured input: right, missed and false names.

Sets by others with known causes (those of ``real``), folders of field cases, and random relay worlds that share no code
with the engine.
"""

import contextlib
import io
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.boxes.relay_worlds import TRUTHS, relay_world
from benchmarks.real import CASES, DATA, QUICK, _imported
from smarig.diagnosis import MeasuredDiagnosis, diagnose_measured
from smarig.identification import identify
from smarig.record import Run
from smarig.study import StudyOptions, study

DEVELOPED_ON = (0, 1, 2, 3, 6, 7, 8, 9)  # seeds of worlds that were looked at while the engine was made
FINAL = (4, 5)
FIELD: dict[
    str, tuple[tuple[str, ...], tuple[str, ...]]
] = {  # right effects, right variables; neither: silence
    "inner_turn_called_change/correlated.csv": ((), ()),
    "inner_turn_called_change/independent.csv": ((), ()),
    "memoryless_called_lag/flat_exact.csv": ((), ()),
    "memoryless_called_lag/flat_n0002.csv": ((), ()),
    "drift_restarts_at_the_split/drift.csv": (("output_drift",), ()),
    "poor_at_the_noise/cycles.csv": ((), ()),
    "near_equal_reversals/q_T2.csv": ((), ()),
    "near_equal_reversals/q_clip.csv": ((), ()),
    "restart_clock/log.csv": ((), ()),
}


@dataclass(frozen=True, eq=False)
class ComparisonCase:
    """Runs with the right ``names``, the right ``variables`` of an unknown verdict; neither: silence."""

    name: str
    train: tuple[Run, ...]
    held_out: tuple[Run, ...]
    names: tuple[str, ...]
    variables: tuple[str, ...]


def run(quick: bool = False, seed: int | None = None) -> dict[str, Any]:
    """Each case with its verdict, and the counts; ``seed``: worlds of this seed alone."""
    rows: dict[str, dict[str, Any]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for case in _cases(Path(folder), quick, (seed,) if seed is not None else FINAL):
            forc = case.train[0].name.startswith("forc")
            model = identify(case.train[:1], "table" if forc else "positive").model
            rows[case.name] = _row(case, diagnose_measured(model, case.train, case.held_out))
    return {"counts": _counts(list(rows.values())), "cases": rows}


def _cases(folder: Path, quick: bool, seeds: Sequence[int]) -> Iterator[ComparisonCase]:
    if DATA.is_dir():
        yield from _real(folder, quick)
        yield from _field(folder, quick)
    for seed in seeds[:1] if quick else seeds:
        for kind in TRUTHS:
            world = relay_world(kind, seed)
            yield ComparisonCase(world.name, world.train, world.held_out, world.names, world.variables)


def _real(folder: Path, quick: bool) -> Iterator[ComparisonCase]:
    for case in CASES:
        if not quick or case.name in QUICK:
            train, held_out = (
                tuple(_imported(f, folder) for f in files) for files in (case.train, case.held_out)
            )
            yield ComparisonCase(case.name, train, held_out, case.names, case.variables)


def _field(folder: Path, quick: bool) -> Iterator[ComparisonCase]:
    for number, (name, (names, variables)) in enumerate(FIELD.items()):
        if quick and number:
            return
        with contextlib.redirect_stderr(io.StringIO()):
            split = study(
                [DATA / "field_cases" / name], folder / f"field{number}", StudyOptions(diagnose=False)
            ).split
        if split is not None:
            held_out = () if split.select else split.held_out
            yield ComparisonCase(name, split.train, held_out, names, variables)


def _row(case: ComparisonCase, found: MeasuredDiagnosis) -> dict[str, Any]:
    verdict, gain = found.verdict, found.gain
    named = set(verdict.names) if verdict.word == "named" else set()
    truth = [w for p, w in found.causes.items() if p.name in (case.names or case.variables)]
    known = bool(case.names or case.variables)
    return {
        "outcome": outcome(case, named, verdict.depends_on, verdict.names),
        "verdict": verdict.word,
        "names": list(verdict.names),
        "depends_on": verdict.depends_on,
        "probability_of_truth": max(truth, default=0.0) if known else found.evidence.weights.nothing,
        "extended": found.extended,
        "left_out": [found.base.rms, found.best.rms if found.best else None],
        "held_out": [gain.base, gain.extended] if gain else None,
        "seconds": round(found.seconds, 1),
    }


def outcome(case: ComparisonCase, named: set[str], depends_on: str | None, candidates: Sequence[str]) -> str:
    """right; false name; set (the truth is among several candidates); missed."""
    if named - set(case.names):
        return "false name"
    if named or depends_on in case.variables:
        return "right"
    if set(candidates) & set(case.names):
        return "set"
    return "missed" if case.names or case.variables else "right"


def _counts(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    found = [row["outcome"] for row in rows]
    counts = {word: found.count(word) for word in ("right", "set", "missed", "false name")}
    return counts | {"median_seconds": float(np.median([row["seconds"] for row in rows]))}
