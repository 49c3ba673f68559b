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


@dataclass(frozen=True)
class AgainstCurves:
    """How a model compares with simple curves fitted to the same data: the error of the best of them over its error.

    ``full_loops``: that curve has a rising and a falling branch, so the data hold full loops only, and a model that is
    as good is no worse for it.
    """

    gain: float
    full_loops: bool = False


@dataclass(frozen=True)
class ErrorParts:
    """What an average hides: the rms errors of one whole branch, and of a part of a branch, over the range of the
    output; the share of the data for which the model has no prediction; and whether the data cannot show its worth.
    """

    worst_branch: float = 0.0
    worst_place: float = 0.0
    unpredicted: float = 0.0
    doubtful: bool = False


def error_verdict(
    rms: float,
    floor: float | None,
    share: float,
    repeatability: Repeatability = STEADY,
    *,
    curves: AgainstCurves | None = None,
    parts: ErrorParts | None = None,
) -> ErrorVerdict:
    """The verdict on an rms error with the noise floor (None: unknown) and its share of the measured travel.

    Where repeats differ by many times the noise of a reading, an error as large as theirs is fair at best. ``curves``:
    where simple curves were fitted to the same data. An error above the noise is fair then if the model is clearly
    better than each of them, up to 15 % of the travel; a model that is hardly better than a curve is poor.

    >>> error_verdict(0.5, 0.05, 0.04).text
    '10 × the noise floor: poor'
    >>> error_verdict(0.5, 0.05, 0.04, Repeatability(drift=0.004)).text
    '10 × the noise floor: poor; repeats drift by 0.4 % of the travel per cycle'
    >>> error_verdict(0.5, 0.05, 0.04, curves=AgainstCurves(6.0)).text
    '10 × the noise floor: fair'
    >>> error_verdict(0.05, 0.05, 0.004, parts=ErrorParts(worst_branch=0.2)).text
    'at the noise floor: poor'
    """
    found = _of_error(rms, floor, share)
    if found.level is ErrorLevel.GOOD and repeatability.over_readings is not None:
        found = _sized(ErrorLevel.FAIR, "at the scatter of repeats")
    if curves is not None:
        found = _at_level(found, _against_curves(found.level, floor, share, curves))
    if parts is not None:
        found = _at_level(found, _with_parts(found.level, parts))
    return replace(found, text=f"{found.text}; {repeatability.text}") if repeatability.text else found


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


def _at_level(found: ErrorVerdict, level: ErrorLevel) -> ErrorVerdict:
    return found if level is found.level else _sized(level, found.size)


def _against_curves(
    level: ErrorLevel, floor: float | None, share: float, curves: AgainstCurves
) -> ErrorLevel:
    """The level of an error beside those of simple curves."""
    gain, full_loops = curves.gain, curves.full_loops
    better = full_loops or not gain < BETTER
    if full_loops and share <= SMALL_SHARE:
        return ErrorLevel.GOOD  # a curve of two branches may be nearer still, and knows full loops only
    if gain < (1 / HARDLY_BETTER if full_loops else HARDLY_BETTER):
        return ErrorLevel.POOR
    if full_loops and gain < BETTER and level is not ErrorLevel.GOOD:
        return ErrorLevel.FAIR if level is ErrorLevel.UNKNOWN else level
    if level is ErrorLevel.GOOD:
        return ErrorLevel.GOOD if better else ErrorLevel.FAIR
    if share > LARGE_SHARE:
        return ErrorLevel.POOR
    if better:
        small = SMALL_SHARE if floor else SMALL_UNKNOWN
        return ErrorLevel.GOOD if share <= small else ErrorLevel.FAIR
    return ErrorLevel.FAIR if level is ErrorLevel.UNKNOWN else level


def _with_parts(level: ErrorLevel, parts: ErrorParts) -> ErrorLevel:
    """The level, lowered where the average hides a part of the data."""
    if parts.worst_branch > LARGE_SHARE or parts.unpredicted > MOSTLY_UNPREDICTED:
        return ErrorLevel.POOR
    hidden = (
        parts.worst_branch > POOR_SHARE
        or parts.worst_place > LARGE_PLACE
        or parts.unpredicted > LITTLE_UNPREDICTED
        or parts.doubtful
    )
    return ErrorLevel.FAIR if level is ErrorLevel.GOOD and hidden else level


def ratio_text(ratio: float) -> str:
    """A ratio with two digits, without an exponent.

    >>> ratio_text(1.26), ratio_text(421.3)
    ('1.3', '421')
    """
    return f"{ratio:.2g}" if ratio < 100 else f"{ratio:.0f}"
