"""Does one proposed run settle a mystery? The rig ``mystery`` end to end, as a newcomer would go about it.

characterise → diagnose → propose → run what was proposed → diagnose again, a seed at a time; the twin's secret is
looked at last. Knows no wire but that twin.
"""

import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from smarig.app import characterise, propose_run
from smarig.core import UsageError
from smarig.diagnosis import Diagnosis, diagnose
from smarig.plant import mystery_effects
from smarig.record import load_run
from smarig.runner import Session

RIG, ARRANGEMENT = "mystery", "one_wire"
NO_ALARM = ("silent", "not_identifiable")
QUICK = 2


def run(quick: bool = False, boxes: int = 20, seed: int = 0, workers: int = 1) -> dict[str, Any]:
    """``{"right", "wrong", "rows": [...]}``: shares of seeds ``seed`` … ``seed + boxes − 1``, and a row for each.

    Right: silent where nothing is hidden, or nothing that these channels could show; else the hidden effect's name.
    Wrong: a name, and not the hidden one.
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
    """What was said at first, what was proposed, what was said then, and what was hidden."""
    with tempfile.TemporaryDirectory() as folder:
        wire = f"mystery {folder}"
        evidence = characterise(RIG, Path(folder) / "wire", seed=seed, wire=wire).evidence
        first = evidence.diagnosis
        assert first is not None  # noqa: S101 - the twin's runs can always be judged
        proposal, last = propose_run(first), first
        if proposal is not None:
            best = proposal.best
            with Session(RIG, seed=seed, wire=wire) as session:
                path = session.run(best.protocol, best.settings, Path(folder) / "separating.run.sqlite")
            training_paths = {run.path for run in first.timeline.runs}
            validation = [run for run in evidence.runs.values() if run.path not in training_paths]
            model = evidence.identifications[evidence.chosen].model
            last = diagnose(model, [*first.timeline.runs, load_run(path)], validation)
    hidden = mystery_effects(seed, ARRANGEMENT)
    return {
        "seed": seed,
        "hidden": [effect.to_json() for effect in hidden],
        "first": _verdict_record(first),
        "proposed": proposal.best.to_json() if proposal else None,
        "last": _verdict_record(last),
        "outcome": outcome(last, [effect.kind.name for effect in hidden]),
    }


def _verdict_record(found: Diagnosis) -> dict[str, Any]:
    return {"verdict": found.verdict.word, "set": list(found.verdict.names), "on": found.verdict.depends_on}


def outcome(found: Diagnosis, hidden: Sequence[str]) -> str:
    """``right``, ``wrong`` (a name that is not the hidden one's), or ``open``."""
    answer = found.verdict
    if answer.word in NO_ALARM:
        return "right" if set(hidden) <= set(found.visibility.invisible) else "open"
    if answer.word == "named":
        return "right" if set(answer.names) == set(hidden) else "wrong"
    return "open" if hidden else "wrong"
