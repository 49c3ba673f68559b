"""Scores of opened boxes: false alarms, detection, names, sets, parameters and gain, with exact bounds of
the counts.

Bounds are those of Clopper and Pearson: 95 % two-sided, except for false alarms, whose upper bound is
one-sided 95 %.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from scipy.special import betaincinv

from benchmarks.boxes.box_effects import EFFECTS, INVISIBLE_WITHOUT

Record = dict[str, Any]
NO_ALARM = ("silent", "not_identifiable")
LEAST_PROBABILITY = 1e-3  # in the log score: no answer is certain
DELTAS = (0.0, 0.1, 0.2, 0.35, 0.5, 1.0, 2.0, np.inf)


_CLOCK = frozenset({"time", "cycle", "reversals"})  # in one session they grow together
_HISTORY = frozenset({"history", "step", "hold"})
STATE_VARIABLES = frozenset({"level"}) | _HISTORY  # effects that depend on the present state of the wire


def score_table(records: Sequence[Record]) -> dict[str, Any]:
    """The table of all figures."""
    good = [r for r in records if "error" not in r]
    empty = [r for r in good if r["category"] in ("empty", "hard_null")]
    single = [r for r in good if r["category"] == "one" and not r["left_out"]]
    visible = [r for r in single if not _invisible(r)]
    large = [r for r in visible if _alarm(r) and _delta(r) >= 1]
    right = [r for r in visible if _named_right(r)]
    left_out = [r for r in good if r["left_out"]]
    two = [r for r in good if r["category"] == "two"]
    return {
        "boxes": len(records),
        "failed": [[r["number"], r["error"]] for r in records if "error" in r],
        "false_alarms": rate(empty, _alarm) | {"upper95": _upper(empty, _alarm)},
        "false_alarms_hard": rate([r for r in empty if r["category"] == "hard_null"], _alarm),
        "detection": {
            "delta>=0.5": rate([r for r in single if _delta(r) >= 0.5], _alarm),
            "delta>=1": rate([r for r in single if _delta(r) >= 1], _alarm),
            "by_delta": _power(single),
        },
        "name": {
            "strict": rate(large, _first_right),
            "group": rate(large, _first_confusable),
            "set_covers": rate(large, lambda r: _hidden(r) in r["set"]),
            "mean_set_size": _mean([len(r["set"]) for r in large if r["set"]]),
        },
        "named_though_unidentifiable": rate([r for r in single if _invisible(r)], _named),
        "left_out": {
            "unknown_right": rate([r for r in left_out if _alarm(r)], _unknown_right),
            "or_group": rate(
                [r for r in left_out if _alarm(r)], lambda r: _unknown_right(r) or _set_confusable(r)
            ),
            "alarms": rate(left_out, _alarm),
        },
        "probability": _probabilities(single, empty),
        "parameter": _parameters(right),
        "removable_share": median([s for r in right if (s := removable_share(r)) is not None]),
        "two": {
            "both": rate([r for r in two if _both_visible(r)], _both),
            "both_of_all": rate(two, _both),
        },
        "seconds": {
            "mean": _mean([r["seconds"] for r in good]),
            "most": max((r["seconds"] for r in good), default=None),
        },
        "by_effect": {name: _of_effect([r for r in single if _hidden(r) == name]) for name in EFFECTS},
        "confusion": _confusion(good),
    }


def _hidden(r: Record) -> str:
    return next(iter(r["hidden"]), "")


def _delta(r: Record) -> float:
    return max(r["delta"].values(), default=0.0)


def _alarm(r: Record) -> bool:
    return r["verdict"] not in NO_ALARM


def _named(r: Record) -> bool:
    return r["verdict"] == "named"


def _invisible(r: Record) -> bool:
    """Whether no record with these channels can show the hidden effect."""
    needs = INVISIBLE_WITHOUT.get(_hidden(r))
    return needs is not None and not set(needs) & set(r["channels"])


def _first(r: Record) -> list[str]:
    return r["explanations"][0][0] if r["explanations"] else []


def _first_right(r: Record) -> bool:
    return r["verdict"] in ("named", "ambiguous") and _first(r) == [_hidden(r)]


def _first_confusable(r: Record) -> bool:
    return r["verdict"] in ("named", "ambiguous") and any(confusable(_hidden(r), name) for name in _first(r))


def _named_right(r: Record) -> bool:
    return _first_right(r)


def _unknown_right(r: Record) -> bool:
    return r["verdict"] == "unknown" and is_correct_variable(r["left_out"], r["depends_on"])


def _set_confusable(r: Record) -> bool:
    return r["verdict"] == "ambiguous" and all(confusable(r["left_out"], name) for name in r["set"])


def _both_visible(r: Record) -> bool:
    return min(r["delta"].values()) >= 0.5


def _both(r: Record) -> bool:
    return r["verdict"] in ("named", "ambiguous") and set(r["set"]) == set(r["hidden"])


def removable_share(r: Record) -> float | None:
    """R on held-out runs; None without them, or if nothing can be removed."""
    return r["held_out"]["removable_share"] if r.get("held_out") else None


def rate(records: Sequence[Record], condition: Callable[[Record], bool]) -> dict[str, Any]:
    """Hits of a condition with their 95 % bounds (Clopper–Pearson)."""
    n, k = len(records), sum(map(condition, records))
    low = float(betaincinv(k, n - k + 1, 0.025)) if k else 0.0
    high = float(betaincinv(k + 1, n - k, 0.975)) if k < n else 1.0
    return {"hits": k, "of": n, "rate": k / n if n else None, "ci95": [low, high] if n else None}


def _upper(records: Sequence[Record], condition: Callable[[Record], bool]) -> float | None:
    n, k = len(records), sum(map(condition, records))
    return (float(betaincinv(k + 1, n - k, 0.95)) if k < n else 1.0) if n else None


def _power(records: Sequence[Record]) -> list[dict[str, Any]]:
    return [
        {"from": low, "to": high if np.isfinite(high) else None}
        | rate([r for r in records if low <= _delta(r) < high], _alarm)
        for low, high in zip(DELTAS, DELTAS[1:])
    ]


def _probabilities(single: Sequence[Record], empty: Sequence[Record]) -> dict[str, Any]:
    """What the answers give to the truth, for δ ≥ 1, and the mean log score of these and of empty boxes."""
    large = [probability_of_truth(r) for r in single if _delta(r) >= 1]
    every = [*large, *map(probability_of_truth, empty)]
    scores = [float(np.log(max(p, LEAST_PROBABILITY))) for p in every]
    return {"mean": _mean(large), "median": median(large), "log_score": _mean(scores)}


def probability_of_truth(r: Record) -> float:
    """What an answer gives to the truth: the hidden effect, the mean of two, or nothing."""
    if not r["hidden"] or r["category"] == "hard_null":
        return float(r["nothing"])
    return float(np.mean([sum(w for n, w in r["explanations"] if name in n) for name in r["hidden"]]))


def _parameters(records: Sequence[Record]) -> dict[str, Any]:
    """Of the primary parameter of correctly named effects: median relative error, coverage of 90 %
    intervals."""
    errors, covered = [], []
    for r in records:
        name = _hidden(r)
        key, true = next(iter(r["hidden"][name].items()))
        found = next((e for e in r["effects"] if e["name"] == name), None)
        if found is None:
            continue
        errors.append(abs(found["parameters"][key]["value"] - true) / abs(true))
        ends = r["intervals90"].get(f"{name}.{key}")
        if ends:
            covered.append({"inside": ends[0] <= true <= ends[1]})
    return {"median_error": median(errors), "coverage90": rate(covered, lambda c: c["inside"])}


def _of_effect(records: Sequence[Record]) -> dict[str, Any]:
    detectable = [r for r in records if _delta(r) >= 1 and not _invisible(r)]
    found = [r for r in detectable if _alarm(r)]
    return {
        "boxes": len(records),
        "delta>=1": len(detectable),
        "detected": len(found),
        "named": sum(map(_first_right, found)),
        "in_set": sum(_hidden(r) in r["set"] for r in found),
    }


def _confusion(records: Iterable[Record]) -> dict[str, dict[str, int]]:
    """Answers by hidden effects; an answer is the first explanation, or the verdict."""
    rows: dict[str, Counter[str]] = {}
    for r in records:
        hidden = (
            (f"without {r['left_out']}" if r["left_out"] else "")
            or " + ".join(sorted(r["hidden"]))
            or "nothing"
        )
        answer = " + ".join(_first(r)) if r["verdict"] in ("named", "ambiguous") else r["verdict"]
        rows.setdefault(hidden, Counter())[answer] += 1
    return {name: dict(rows[name].most_common()) for name in sorted(rows)}


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None


def median(values: Sequence[float]) -> float | None:
    """The median, or None of nothing."""
    return float(np.median(values)) if values else None


GROUPS: tuple[frozenset[str], ...] = (
    frozenset({"resistance_phase", "stress_coupling", "noncongruency", "eccentricity", "backlash"}),
    frozenset({"ambient_drift", "fatigue", "walking", "slip"}),
    frozenset({"settling", "creep"}),
    frozenset({"accommodation", "settling", "temperature_memory"}),
    frozenset({"wire_lag", "latent_heat", "sensor_lag", "convection"}),
    frozenset({"amplifier_gain", "dead_zone", "saturation"}),
    frozenset({"r_phase", "thermal_expansion", "end_conduction", "coulomb_friction", "noncongruency"}),
    frozenset({"slack", "dead_zone", "backlash"}),
)
VARIABLES: dict[str, frozenset[str]] = {
    **dict.fromkeys(("ambient_drift", "fatigue", "walking", "slip"), _CLOCK),
    **dict.fromkeys(("settling", "creep", "cross_talk"), _HISTORY | {"rate"} | _CLOCK),
    **dict.fromkeys(("accommodation", "temperature_memory", "backlash"), _HISTORY | {"level", "cycle"}),
    **dict.fromkeys(("wire_lag", "sensor_lag", "latent_heat", "convection"), frozenset({"rate", "step"})),
}


def confusable(a: str, b: str) -> bool:
    """Whether two effects share a group."""
    return a == b or any(a in group and b in group for group in GROUPS)


def is_correct_variable(effect: str, variable: str | None) -> bool:
    """Whether the effect depends on this variable."""
    return variable is not None and variable in VARIABLES.get(effect, STATE_VARIABLES)
