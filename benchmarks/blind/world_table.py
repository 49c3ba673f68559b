"""Scores of boxes by world: wires that follow a kinetic law, and mechanisms outside every catalogue.

A name on such a box is an error, unless it says the same as the mechanism (a room that swings is ambient drift). The
right answer is "unknown", with a variable that the mechanism depends on.
"""

from collections.abc import Sequence
from typing import Any

from benchmarks.blind.score_table import NO_ALARM, Record, median, rate, removable_share
from benchmarks.boxes.label import KINETIC, UNLISTED_CATEGORY
from benchmarks.boxes.unlisted_effects import HISTORY, UNLISTED

NOT_PREISACH = HISTORY | {"level", "cycle"}  # what minor loops that do not return depend on


def world_table(records: Sequence[Record]) -> dict[str, Any]:
    """Names given (all errors), alarms, and right variables by world, for boxes with δ ≥ 1 and for all."""
    good = [r for r in records if "error" not in r]
    kinetic = [r for r in good if r["category"] == KINETIC]
    unlisted = [r for r in good if r["category"] == UNLISTED_CATEGORY]
    large = [r for r in unlisted if _delta(r) >= 1]
    foreign = [r for r in (*kinetic, *unlisted) if _delta(r) >= 1]
    return {
        "learned delta>=1": {
            "offered": rate(foreign, lambda r: bool(r.get("learned"))),
            "worse": rate(foreign, _worse),
            "median_R": median([removable_share(r) or 0.0 for r in foreign]),
            "median_R_offered": median([removable_share(r) or 0.0 for r in foreign if r.get("learned")]),
        },
        "kinetic": {
            "named": rate(kinetic, _named),
            "not_preisach_or_history": rate(kinetic, _not_preisach),
            "unknown": rate(kinetic, lambda r: r["verdict"] == "unknown"),
        },
        "unlisted": {
            "named": rate(unlisted, _named),
            "alarms delta>=1": rate(large, lambda r: r["verdict"] not in NO_ALARM),
            "right variable delta>=1": rate(large, _right_variable),
        },
        "by_mechanism": {
            name: _of_mechanism([r for r in unlisted if name in r["hidden"]]) for name in UNLISTED
        },
    }


def _worse(r: Record) -> bool:
    """Whether an extension was offered that predicts held-out runs worse than the base model."""
    gain = r.get("held_out")
    return bool(gain) and gain["extended"] > gain["base"]


def _delta(r: Record) -> float:
    return max(r["delta"].values(), default=0.0)


def _named(r: Record) -> bool:
    """Whether a wrong name was given."""
    right = {name for hidden in r["hidden"] if hidden in UNLISTED for name in UNLISTED[hidden].right_names}
    return r["verdict"] in ("named", "ambiguous") and not set(r["set"]) <= right


def _not_preisach(r: Record) -> bool:
    return r["verdict"] == "unknown" and r["depends_on"] in NOT_PREISACH


def _right_variable(r: Record) -> bool:
    if r["verdict"] == "unknown":
        return all(r["depends_on"] in UNLISTED[name].variables for name in r["hidden"])
    return r["verdict"] in ("named", "ambiguous") and not _named(r)


def _of_mechanism(records: Sequence[Record]) -> list[str]:
    """The answers, one for each box."""
    return [" + ".join(r["set"]) if _named(r) else str(r["depends_on"] or r["verdict"]) for r in records]
