"""The verdict on an error: how it compares with the noise of the readings."""

from dataclasses import dataclass, replace
from enum import StrEnum

from smarig.identification.repeatability import STEADY, Repeatability
from smarig.identification.verdict_thresholds import (
    BETTER,
    GOOD_RATIO,
    HARDLY_BETTER,
    LARGE_PLACE,
    LARGE_SHARE,
    LITTLE_UNPREDICTED,
    MOSTLY_UNPREDICTED,
    POOR_RATIO,
    POOR_SHARE,
    SMALL_SHARE,
    SMALL_UNKNOWN,
)


class ErrorLevel(StrEnum):
    """What an error says about a model."""

    GOOD = "good"
    FAIR = "fair"
    POOR = "poor"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class ErrorVerdict:
    """The ``level`` of an error, and in words its ``size`` relative to the noise, and both with what limits them."""

    level: ErrorLevel
    size: str
    text: str


def error_verdict(
    rms: float, floor: float | None, share: float, repeatability: Repeatability = STEADY
) -> ErrorVerdict:
    """The verdict on an rms error with the noise floor (None: unknown) and its share of the measured travel.

    Where repeats differ by many times the noise of a reading, an error as large as theirs is fair at best.

    >>> error_verdict(0.5, 0.05, 0.04).text
    '10 × the noise floor: poor'
    >>> error_verdict(0.5, 0.05, 0.04, Repeatability(drift=0.004)).text
    '10 × the noise floor: poor; repeats drift by 0.4 % of the travel per cycle'
    """
    found = _of_error(rms, floor, share)
    if not repeatability.text:
        return found
    if found.level is ErrorLevel.GOOD and repeatability.over_readings is not None:
        found = _sized(ErrorLevel.FAIR, "at the scatter of repeats")
    return replace(found, text=f"{found.text}; {repeatability.text}")


def _of_error(rms: float, floor: float | None, share: float) -> ErrorVerdict:
    """The verdict without regard to the repeats."""
    if floor:
        ratio = rms / floor
        if ratio <= GOOD_RATIO:
            return _sized(ErrorLevel.GOOD, "at the noise floor")
        level = ErrorLevel.FAIR if ratio <= POOR_RATIO else ErrorLevel.POOR
        return _sized(level, f"{_above_threshold_text(ratio)} × the noise floor")
    if not share >= 0:
        return ErrorVerdict(ErrorLevel.UNKNOWN, "", "the output does not move, and the noise is unknown")
    percent = f"{100 * share:.2g} % of the travel"
    if share > POOR_SHARE:
        return ErrorVerdict(ErrorLevel.POOR, percent, f"{percent}: poor; the noise is unknown")
    return ErrorVerdict(ErrorLevel.UNKNOWN, percent, f"{percent}; the noise is unknown")


def _sized(level: ErrorLevel, size: str) -> ErrorVerdict:
    return ErrorVerdict(level, size, f"{size}: {level}")


def _above_threshold_text(ratio: float) -> str:
    """A ratio with as many digits as distinguish it from the thresholds: 1.504 is fair, 1.5 would be good."""
    text = ratio_text(ratio)
    return f"{ratio:.4g}" if float(text) in (GOOD_RATIO, POOR_RATIO) else text


def level_against_curves(
    rms: float,
    floor: float | None,
    share: float,
    gain: float,
    repeatability: Repeatability = STEADY,
    *,
    full_loops: bool = False,
) -> ErrorLevel:
    """The level of an error where simple curves were fitted to the same data: ``gain`` is the error of the best of
    them over that of the model (NaN: none).

    The thresholds are those of ``error_verdict``. An error above the noise is fair if the model is clearly better than
    each curve, up to 15 % of the travel; a model that is hardly better than a curve is poor. ``full_loops``: that curve
    has a rising and a falling branch, so the data hold full loops only, and a model that is as good is no worse for it.

    >>> str(level_against_curves(0.5, 0.05, 0.04, 6.0)), str(level_against_curves(0.5, 0.05, 0.04, 1.1))
    ('fair', 'poor')
    >>> str(level_against_curves(0.05, 0.05, 0.004, 1.0, full_loops=True))
    'good'
    """
    level, better = error_verdict(rms, floor, share, repeatability).level, full_loops or not gain < BETTER
    if gain < (1 / HARDLY_BETTER if full_loops else HARDLY_BETTER):
        return ErrorLevel.POOR
    if full_loops and gain < BETTER and level is not ErrorLevel.GOOD:
        at_best = ErrorLevel.FAIR if level is ErrorLevel.UNKNOWN else level
        return ErrorLevel.GOOD if share <= SMALL_SHARE else at_best
    if level is ErrorLevel.GOOD:
        return ErrorLevel.GOOD if better else ErrorLevel.FAIR
    if share > LARGE_SHARE:
        return ErrorLevel.POOR
    if better:
        small = SMALL_SHARE if floor else SMALL_UNKNOWN
        return ErrorLevel.GOOD if share <= small else ErrorLevel.FAIR
    return ErrorLevel.FAIR if level is ErrorLevel.UNKNOWN else level


def level_of_parts(
    level: ErrorLevel, worst_branch: float, worst_place: float, unpredicted: float
) -> ErrorLevel:
    """The level of an error, lowered where the average hides a part of the data.

    ``worst_branch`` and ``worst_place``: the rms errors of one whole branch, and of a part of a branch, over the range
    of the output. ``unpredicted``: the share of the data for which the model has no prediction.

    >>> str(level_of_parts(ErrorLevel.FAIR, 0.2, 0.2, 0.0)), str(level_of_parts(ErrorLevel.GOOD, 0.01, 0.02, 0.3))
    ('poor', 'fair')
    """
    if worst_branch > LARGE_SHARE or unpredicted > MOSTLY_UNPREDICTED:
        return ErrorLevel.POOR
    hidden = worst_branch > POOR_SHARE or worst_place > LARGE_PLACE or unpredicted > LITTLE_UNPREDICTED
    if level is ErrorLevel.GOOD and hidden:
        return ErrorLevel.FAIR
    return level


def ratio_text(ratio: float) -> str:
    """A ratio with two digits, without an exponent.

    >>> ratio_text(1.26), ratio_text(421.3)
    ('1.3', '421')
    """
    return f"{ratio:.2g}" if ratio < 100 else f"{ratio:.0f}"
