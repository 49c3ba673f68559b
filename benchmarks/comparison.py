"""The comparison of hypotheses on records with a measured input, beside the earlier diagnosis.

Sets by others with known causes (those of ``real``), folders of field cases, and random relay worlds that share no code
with the engine. ``earlier``: also run the earlier diagnosis; its answers are kept in the file ``out``.
"""

import contextlib
import io
import json
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.boxes.relay_worlds import TRUTHS, relay_world
from benchmarks.real import CASES, DATA, QUICK, _imported
from smarig.diagnosis import MeasuredComparison, MeasuredDiagnosis, compare_measured, diagnose
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


def run(quick: bool = False, seed: int | None = None, out: str | None = None) -> dict[str, Any]:
    """Each case with both verdicts, and the counts; ``seed``: worlds of this seed alone."""
    kept = _Kept(Path(out)) if out else None
    rows: dict[str, dict[str, Any]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for case in _cases(Path(folder), quick, (seed,) if seed is not None else FINAL):
            found = compare_measured(case.train, case.held_out)
            rows[case.name] = _row(case, found) | ({"earlier": kept.answer(case)} if kept else {})
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


def _row(case: ComparisonCase, found: MeasuredComparison) -> dict[str, Any]:
    verdict = found.verdict
    named = set(verdict.names) if verdict.word == "named" else set()
    truth = [w for p, w in found.causes.items() if p.name in (case.names or case.variables)]
    best = found.held_out.get(found.weights.heaviest.name)
    return {
        "outcome": outcome(case, named, verdict.depends_on, verdict.names),
        "verdict": verdict.word,
        "names": list(verdict.names),
        "depends_on": verdict.depends_on,
        "probability_of_truth": max(truth, default=0.0)
        if case.names or case.variables
        else found.weights.nothing,
        "held_out": [found.held_out.get("nothing"), best],
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


class _Kept:
    """Answers of the earlier diagnosis in a file, so that it need not run again."""

    def __init__(self, path: Path):
        self.path = path
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        self.rows = {row["name"]: row for row in map(json.loads, lines)}

    def answer(self, case: ComparisonCase) -> dict[str, Any]:
        row = self.rows.get(case.name) or self._diagnosed(case)
        named = set(row["names"]) if row["extended"] and row.get("word") == "named" else set()
        return row | {"outcome": outcome(case, named, row["depends_on"], row["names"])}

    def _diagnosed(self, case: ComparisonCase) -> dict[str, Any]:
        forc = case.train[0].name.startswith("forc")
        d = diagnose(
            identify(case.train[:1], "table" if forc else "positive").model, case.train, case.held_out
        )
        row: dict[str, Any] = {"name": case.name, "names": [], "depends_on": None, "extended": False}
        if isinstance(d, MeasuredDiagnosis):
            row |= {
                "word": d.verdict.word,
                "names": list(d.verdict.names),
                "depends_on": d.verdict.depends_on,
                "extended": d.extended,
                "base": d.gain and d.gain.base,
                "ext": d.gain and d.gain.extended,
                "seconds": d.seconds,
            }
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        return row


def _counts(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    def of(answers: Sequence[dict[str, Any]]) -> dict[str, Any]:
        found = [a["outcome"] for a in answers]
        counts = {word: found.count(word) for word in ("right", "set", "missed", "false name")}
        return counts | {"median_seconds": float(np.median([a.get("seconds", np.nan) for a in answers]))}

    earlier = [row["earlier"] for row in rows if "earlier" in row]
    return {"comparison": of(rows)} | ({"earlier": of(earlier)} if earlier else {})
