"""The files of a study in its folder, and the word for what it found with how serious that is."""

from collections.abc import Mapping
from typing import Any

STUDY_JSON, STUDY_PAGE, STUDY_MODEL = "study.json", "index.html", "model.json"
VERDICT_LEVELS = {"good": "good", "fair": "warning", "poor": "bad"}  # of boxes and marks


def outcome_word(found: Mapping[str, Any]) -> str:
    """The verdict of a study, by its JSON object; for data without a model, what they are.

    >>> outcome_word({"verdict": "fair"}), outcome_word({"verdict": None, "calorimetry": None})
    ('fair', 'heating only')
    """
    return str(found.get("verdict") or ("heat flow" if found.get("calorimetry") else "heating only"))
