"""Diagnosis of the rig ``mystery`` with one proposed run, as a new user would do it.

For each seed: characterise, diagnose_commanded, propose, execute the proposed run, diagnose again. The hidden effect
of the twin is read last.
"""

import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from smarig.app import characterise, propose_run
from smarig.core import UsageError
from smarig.diagnosis import CommandedDiagnosis, diagnose_commanded
from smarig.plant import mystery_effects
from smarig.record import load_run
from smarig.runner import Session

RIG, ARRANGEMENT = "mystery", "one_wire"
NO_ALARM = ("silent", "not_identifiable")
QUICK = 2


def run(quick: bool = False, boxes: int = 20, seed: int = 0, workers: int = 1) -> dict[str, Any]:
    """``{"right", "wrong", "rows": [...]}``: shares of seeds ``seed`` … ``seed + boxes − 1``, and a row for
    each.

    Right: no finding if nothing is hidden or these channels cannot show it; otherwise the name of the hidden effect.
    Wrong: the name of another effect.
    """
    if boxes < 1 or workers < 1:
        raise UsageError(f"At least one seed and one worker are needed, not {boxes} and {workers}.")
    rows = list(_rows(range(seed, seed + (QUICK if quick else boxes)), workers))
    return {
        "right": sum(row["outcome"] == "right" for row in rows) / len(rows),
        "wrong": sum(row["outcome"] == "wrong" for row in rows) / len(rows),
        "rows": rows,
    }


def _rows(seeds: Sequence[int], workers: int) -> Iterator[dict[str, Any]]:
    if workers == 1:
        yield from map(solve_seed, seeds)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        yield from pool.map(solve_seed, seeds)


def solve_seed(seed: int) -> dict[str, Any]:
    """The first result, the proposal, the second result, and the hidden effects of one seed."""
    with tempfile.TemporaryDirectory() as folder:
        wire = f"mystery {folder}"
        evidence = characterise(RIG, Path(folder) / "wire", seed=seed, wire=wire).evidence
        first = evidence.diagnosis
        assert first is not None  # noqa: S101 - the runs of the twin can always be evaluated
        proposal, last = propose_run(first), first
        if proposal is not None:
            best = proposal.best
            with Session(RIG, seed=seed, wire=wire) as session:
                path = session.run(best.protocol, best.settings, Path(folder) / "separating.run.sqlite")
            training_paths = {run.path for run in first.timeline.runs}
            validation = [run for run in evidence.runs.values() if run.path not in training_paths]
            model = evidence.identifications[evidence.chosen].model
            last = diagnose_commanded(model, [*first.timeline.runs, load_run(path)], validation)
    hidden = mystery_effects(seed, ARRANGEMENT)
    return {
        "seed": seed,
        "hidden": [effect.to_json() for effect in hidden],
        "first": _verdict_record(first),
        "proposed": proposal.best.to_json() if proposal else None,
        "last": _verdict_record(last),
        "outcome": outcome(last, [effect.kind.name for effect in hidden]),
    }


def _verdict_record(found: CommandedDiagnosis) -> dict[str, Any]:
    return {"verdict": found.verdict.word, "set": list(found.verdict.names), "on": found.verdict.depends_on}


def outcome(found: CommandedDiagnosis, hidden: Sequence[str]) -> str:
    """``right``, ``wrong`` (another name than the hidden one), or ``open``."""
    answer = found.verdict
    if answer.word in NO_ALARM:
        return "right" if set(hidden) <= set(found.not_identifiable) else "open"
    if answer.word == "named":
        return "right" if set(answer.names) == set(hidden) else "wrong"
    return "open" if hidden else "wrong"
