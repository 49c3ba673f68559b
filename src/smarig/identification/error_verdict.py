"""The verdict on an error: how it compares with the noise of the readings."""

from dataclasses import dataclass
from enum import StrEnum

GOOD_RATIO, POOR_RATIO = 1.5, 3.0  # of the error to the noise floor
POOR_SHARE = 0.05  # of the travel, where the noise is not known


class ErrorLevel(StrEnum):
    """What an error says about a model."""

    GOOD = "good"
    FAIR = "fair"
    POOR = "poor"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class ErrorVerdict:
    """The ``level`` of an error, and its size relative to the noise as text."""

    level: ErrorLevel
    text: str


def error_verdict(rms: float, floor: float | None, share: float) -> ErrorVerdict:
    """The verdict on an rms error with the noise floor (None: unknown) and its share of the measured travel.

    >>> error_verdict(0.5, 0.05, 0.04).text
    '10 × the noise floor: poor'
    """
    if floor:
        ratio = rms / floor
        if ratio <= GOOD_RATIO:
            return ErrorVerdict(ErrorLevel.GOOD, "at the noise floor: good")
        level = ErrorLevel.FAIR if ratio <= POOR_RATIO else ErrorLevel.POOR
        return ErrorVerdict(level, f"{ratio_text(ratio)} × the noise floor: {level}")
    percent = f"{100 * share:.2g} % of the travel"
    if share > POOR_SHARE:
        return ErrorVerdict(ErrorLevel.POOR, f"{percent}: poor; the noise is unknown")
    return ErrorVerdict(ErrorLevel.UNKNOWN, f"{percent}; the noise is unknown")


def ratio_text(ratio: float) -> str:
    """A ratio with two digits, without an exponent.

    >>> ratio_text(1.26), ratio_text(421.3)
    ('1.3', '421')
    """
    return f"{ratio:.2g}" if ratio < 100 else f"{ratio:.0f}"
