"""The thresholds of the verdicts "good", "fair" and "poor" of ``verify`` and ``study``, and their sentences.

Help and docs/reference/verdicts.md hold these sentences; a test compares them.
"""

GOOD_RATIO, POOR_RATIO = 1.5, 3.0  # of the error to the noise floor
POOR_SHARE = 0.05  # of the travel, where the noise is not known
OVER_READINGS = 4.0  # scatter of repeats over the noise within readings: more than draughts leave

BETTER, HARDLY_BETTER = 1.5, 1.2  # error of the best simple curve over that of the model
SMALL_SHARE = 0.005  # of the travel: an error that does not matter, whatever the noise
SMALL_UNKNOWN = 0.03  # the same, where the noise is not known
LARGE_SHARE = 0.15  # of the travel: poor, even if every simple curve is worse

LARGE_PLACE = 0.1  # of the travel: an error that a reader must see, wherever it is
LITTLE_UNPREDICTED, MOSTLY_UNPREDICTED = 0.05, 0.5  # of the data: where a model has no prediction


def threshold_sentences() -> tuple[str, ...]:
    """How ``verify`` and the pages of a characterisation decide on an rms error at settled points."""
    return (
        f"good: at most {GOOD_RATIO:g} × the noise floor of the run.",
        f"fair: at most {POOR_RATIO:g} × the noise floor; also at the noise floor, if repeats scatter by more than "
        f"{OVER_READINGS:g} × the noise of a reading.",
        "poor: more.",
        "If fewer than three states repeat, the noise floor is unknown: more than "
        f"{_percent(POOR_SHARE)} of the travel is poor, and less has no verdict.",
    )


def study_sentences() -> tuple[str, ...]:
    """What ``study`` decides differently, because it also fits simple curves (lines, parabolas) to the same data."""
    return (
        "If a curve of one rising and one falling branch is about as good as the model, the data hold full loops only. "
        f"The model is then good for full loops at {GOOD_RATIO:g} × the noise floor. At {_percent(SMALL_SHARE)} of the "
        "travel it is good even if the curve is better.",
        f"poor: the error of another simple curve is less than {HARDLY_BETTER:g} × that of the model, or the error is "
        f"more than {_percent(LARGE_SHARE)} of the travel and above {GOOD_RATIO:g} × the noise floor.",
        f"Above {GOOD_RATIO:g} × the noise floor, a model is fair if the error of the best simple curve is at least "
        f"{BETTER:g} × that of the model, and good if its error is also at most {_percent(SMALL_SHARE)} of the travel "
        f"({_percent(SMALL_UNKNOWN)} if the noise is unknown).",
        f"Good becomes fair if one branch is wrong by more than {_percent(POOR_SHARE)} of the travel, one place of a "
        f"branch by more than {_percent(LARGE_PLACE)}, or more than {_percent(LITTLE_UNPREDICTED)} of the data have no "
        "prediction.",
        f"Any level becomes poor if one branch is wrong by more than {_percent(LARGE_SHARE)} of the travel, or more "
        f"than {_percent(MOSTLY_UNPREDICTED)} of the data have no prediction.",
    )


def _percent(share: float) -> str:
    return f"{100 * share:g} %"
