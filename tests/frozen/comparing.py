"""Differences between two answers, as sentences.

In exact mode every bit counts. Otherwise numbers may differ by 1e-6 relative and 1e-9 absolute, because
libraries of linear algebra differ between machines; hashes of numbers are then ignored, and the means beside
them are compared. Names, verdicts and units are compared; the wording of sentences is not.
"""

import math
from collections.abc import Iterator
from typing import Any

RELATIVE, ABSOLUTE = 1e-6, 1e-9
OPTIMISED = {"causes", "hypotheses", "where"}  # of variances at an optimum, which is flat
RELATIVE_OF_OPTIMISED = 1e-3
HASH = "hash"
ADDED = {
    "actuator_text",
    "actuator_values",
    "adequacy",
    "conditions",
    "constant_force_cycles",
    "continuous_reversal_curves",
    "crossing_note",
    "discrepancy",
    "drift_per_cycle",
    "energy",
    "extension",
    "flexinol_015",
    "flexinol_031",
    "gain_any_state",
    "has_lease",
    "gain_from_rest",
    "gain_unit",
    "hidden",
    "indistinguishable_states",
    "integral",
    "integral_action",
    "isothermal_loading",
    "load",
    "laboratory_supply",
    "labjack_one_wire",
    "learned",
    "measured",
    "nearest",
    "no_candidates",
    "noise",
    "one_wire_thermomechanical",
    "over_readings",
    "p_value",
    "position_supply",
    "preisach",
    "preisach_properties",
    "reason",
    "remaining",
    "repairs",
    "repeatability",
    "rig_sha256",
    "rig_values",
    "robust",
    "rows",
    "severity",
    "suspects",
    "transformation",
    "thermomechanical_one_wire",
    "thermomechanical_two_wire",
    "two_wire_thermomechanical",
    "uno_one_wire",
    "verdict",
    "wire_K",
    "without_lease_A",
}  # keys that came later, on purpose
ENDED = {"wire_history", "history_until_tick"}  # keys that runs of twins no longer have, on purpose


def differences(
    before: Any, now: Any, where: str, *, exact: bool, relative: float = RELATIVE
) -> Iterator[str]:
    """One sentence for each."""
    if isinstance(before, dict) and isinstance(now, dict):
        for key in sorted({*before, *now}):
            if key in ENDED or (key in ADDED and key not in before):
                continue
            if key not in now or key not in before:
                yield f"{where}.{key}: {'is gone' if key in before else 'is new'}"
            elif exact or key != HASH:
                own = RELATIVE_OF_OPTIMISED if key in OPTIMISED else relative
                yield from differences(before[key], now[key], f"{where}.{key}", exact=exact, relative=own)
    elif isinstance(before, list) and isinstance(now, list):
        if len(before) != len(now):
            yield f"{where}: {len(before)} items before, {len(now)} now"
        for k, (a, b) in enumerate(zip(before, now)):
            yield from differences(a, b, f"{where}[{k}]", exact=exact, relative=relative)
    elif not _same(before, now, exact, relative):
        yield f"{where}: {before!r} before, {now!r} now"


def _same(before: Any, now: Any, exact: bool, relative: float) -> bool:
    if isinstance(before, float) and isinstance(now, float):
        if math.isnan(before) or math.isnan(now):
            return math.isnan(before) and math.isnan(now)
        return before == now or (not exact and math.isclose(before, now, rel_tol=relative, abs_tol=ABSOLUTE))
    if isinstance(before, str) and isinstance(now, str) and _is_sentence(before) and _is_sentence(now):
        return True
    return type(before) is type(now) and before == now


def _is_sentence(text: str) -> bool:
    """Words for people, as opposed to names, units and verdicts."""
    return len(text.split()) > 3
