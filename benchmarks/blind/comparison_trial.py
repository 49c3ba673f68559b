"""Trials of the comparison of hypotheses on boxes of all worlds, and a table beside another engine's answers.

An answer has the keys of ``benchmarks.blind.trial``, so that both can be scored by the same functions; ``causes`` and
``nothing`` are added. The size δ of what is hidden is taken from the other engine's answers.

    python -m benchmarks.blind.comparison_trial SEED FIRST:LAST ANSWERS [OTHER ANSWERS]
"""

import json
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks.blind.score_table import NO_ALARM, is_correct_variable
from benchmarks.blind.world_table import NOT_PREISACH
from benchmarks.boxes import Part, draw_world_box, write_box
from benchmarks.boxes.label import EMPTY, HARD_NULL, KINETIC, UNLISTED_CATEGORY
from benchmarks.boxes.unlisted_effects import UNLISTED
from smarig.core import SmarigError
from smarig.diagnosis import CommandedComparison, compare_commanded
from smarig.identification import identify
from smarig.record import load_run

Record = dict[str, Any]
LEAST_PROBABILITY = 1e-3  # in the log score: no answer is certain
SILENT_PROBABILITY = 0.98  # of nothing, where an engine is silent and gives none


@threadpool_limits.wrap(limits=1, user_api="blas")
def comparison_trial(seed: int, number: int, part: Part = "public") -> Record:
    """A box's answer by the comparison of hypotheses, and its truth."""
    box = draw_world_box(seed, number, part)
    with tempfile.TemporaryDirectory() as folder:
        sealed = write_box(box, Path(folder))
        label = sealed.label
        truth: Record = {
            "number": number,
            "category": label.category,
            "hidden": label.effects,
            "left_out": label.left_out,
            "channels": list(label.channels),
        }
        without = (box.left_out,) if box.left_out else ()
        started = time.process_time()
        try:
            train, held_out = (
                [load_run(path) for path in paths] for paths in (sealed.train, sealed.held_out)
            )
            found = compare_commanded(identify(train, "positive").model, train, held_out, without=without)
        except SmarigError as error:
            return truth | {"error": str(error)}
    return truth | {"seconds": time.process_time() - started} | answer_of(found)


def answer_of(found: CommandedComparison) -> Record:
    """The answer of a comparison as plain values."""
    effects = [[p.name, w] for p, w in found.causes.items() if p.kind == "effect"]
    variables = [[p.name, w] for p, w in found.causes.items() if p.kind == "variable"]
    return {
        "verdict": found.verdict.word,
        "reason": found.verdict.reason,
        "set": list(found.verdict.names),
        "depends_on": found.verdict.depends_on,
        "explanations": [[[name], w] for name, w in effects],
        "variables": variables,
        "nothing": found.weights.nothing,
        "parameters": found.parameters,
        "intervals90": found.intervals90,
        "held_out": found.gain.to_json() if found.gain else None,
    }


def side_by_side(old: Sequence[Record], new: Sequence[Record]) -> list[list[Any]]:
    """Rows (figure, old, new) over the boxes that both answered."""
    by_number = {r["number"]: r for r in old if "error" not in r}
    both = [(by_number[r["number"]], r) for r in new if r["number"] in by_number and "error" not in r]
    pairs = [(a, b | {"delta": a["delta"]}) for a, b in both]
    columns = [_figures([pair[k] for pair in pairs]) for k in (0, 1)]
    return [[name, columns[0][name], columns[1][name]] for name in columns[0]]


def _figures(answers: Sequence[Record]) -> dict[str, Any]:
    empty = [r for r in answers if r["category"] in (EMPTY, HARD_NULL)]
    named = [r for r in answers if _truth_is_name(r) and _delta(r) >= 1]
    foreign = [r for r in answers if r["category"] in (KINETIC, UNLISTED_CATEGORY) or r["left_out"]]
    large = [r for r in foreign if _delta(r) >= 1]
    probabilities = [probability(r) for r in answers if _delta(r) >= 1 and _truth_is_name(r)]
    gains = [r["held_out"]["removable_share"] or 0.0 for r in answers if r.get("held_out") and _delta(r) >= 1]
    return {
        "boxes": len(answers),
        "false alarms on empty": _share(r["verdict"] not in NO_ALARM for r in empty),
        "first right, δ ≥ 1": _share(_first(r) in r["hidden"] for r in named),
        "named or in set, δ ≥ 1": _share(bool(set(r["set"]) & set(r["hidden"])) for r in named),
        "P of the truth, mean": _mean(probabilities),
        "P of the truth, median": float(np.median(probabilities)) if probabilities else None,
        "false names, foreign": _share(_false_name(r) for r in foreign),
        "right variable or name, foreign, δ ≥ 1": _share(_right_foreign(r) for r in large),
        "log score": _mean([float(np.log(max(probability(r), LEAST_PROBABILITY))) for r in named + empty]),
        "R held out, δ ≥ 1, mean": _mean(gains),
        "R held out, δ ≥ 1, median": float(np.median(gains)) if gains else None,
        "seconds, median": float(np.median([r["seconds"] for r in answers])) if answers else None,
    }


def probability(r: Record) -> float:
    """What an answer gives to the truth: the hidden effect, the mean of two, or nothing."""
    if not r["hidden"] or r["category"] == HARD_NULL:
        silent = SILENT_PROBABILITY if r["verdict"] in NO_ALARM else 1 - SILENT_PROBABILITY
        return float(r.get("nothing", silent))
    if "nothing" not in r and r["verdict"] in NO_ALARM:
        return 0.0
    return float(np.mean([sum(w for n, w in r["explanations"] if name in n) for name in r["hidden"]]))


def _first(r: Record) -> str:
    return r["explanations"][0][0][0] if r["explanations"] and r["verdict"] not in NO_ALARM else ""


def _truth_is_name(r: Record) -> bool:
    return bool(r["hidden"]) and r["category"] in ("one", "two") and not r["left_out"]


def _right_names(r: Record) -> set[str]:
    return {name for hidden in r["hidden"] if hidden in UNLISTED for name in UNLISTED[hidden].right_names}


def _false_name(r: Record) -> bool:
    return r["verdict"] == "named" and not set(r["set"]) <= _right_names(r)


def _right_foreign(r: Record) -> bool:
    if r["verdict"] in ("named", "ambiguous"):
        return bool(r["set"]) and set(r["set"]) <= _right_names(r)
    variable = r["depends_on"]
    if r["category"] == KINETIC:
        return r["verdict"] == "unknown" and variable in NOT_PREISACH
    if r["left_out"]:
        return r["verdict"] == "unknown" and is_correct_variable(r["left_out"], variable)
    return r["verdict"] == "unknown" and all(variable in UNLISTED[n].variables for n in r["hidden"])


def _delta(r: Record) -> float:
    return max(r["delta"].values(), default=0.0)


def _share(hits: Iterable[bool]) -> str:
    found = list(hits)
    return f"{sum(found)} of {len(found)}"


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None


def _read(path: Path) -> list[Record]:
    return [json.loads(line) for line in path.read_text("utf-8").splitlines()] if path.exists() else []


def main(seed: int, numbers: range, out: Path, other: Path | None) -> None:
    """Answer the boxes that a file has not, and print the table beside another engine's answers."""
    done = {r["number"] for r in _read(out)}
    for number in numbers:
        if number not in done:
            record = comparison_trial(seed, number)
            with out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(record) + "\n")
    if other is not None:
        for name, old, new in side_by_side(_read(other), _read(out)):
            sys.stdout.write(f"{name:40} {old!s:>22} {new!s:>22}\n")


if __name__ == "__main__":
    _first_last = [int(k) for k in sys.argv[2].split(":")]
    main(
        int(sys.argv[1]), range(*_first_last), Path(sys.argv[3]), Path(sys.argv[4]) if sys.argv[4:] else None
    )
