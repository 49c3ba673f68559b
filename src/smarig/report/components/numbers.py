"""Formats numbers for pages: few digits, a true minus sign, powers of ten written out."""

import math

ROUNDING = 1e-12  # of a value: what computing it in double precision leaves
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float | None, digits: int = 3) -> str:
    """A number with ``digits`` significant digits; '–' if it is missing.

    >>> number(0.012345), number(-1.93e-4), number(None), number(12.5404), number(1234.5), number(-0.0)
    ('0.0123', '−1.93 × 10⁻⁴', '–', '12.5', '1230', '0')
    """
    if value is None or not math.isfinite(value):
        return "–"
    value += 0.0  # zero has no sign
    if value != 0 and not 1e-3 <= abs(value) < 1e5:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        return f"{mantissa} × 10{raised(int(exponent))}".replace("-", "−")
    text = f"{value:.{digits}g}"
    return (f"{float(text):.0f}" if "e" in text else text).replace("-", "−")


def signed(value: float, digits: int = 3) -> str:
    """A number with its sign, also if positive; zero has no sign.

    >>> signed(0.0272), signed(-1.5), signed(-0.0)
    ('+0.0272', '−1.5', '0')
    """
    return f"+{number(value, digits)}" if value > 0 else number(value, digits)


def has_width(low: float, high: float) -> bool:
    """Whether the ends of an interval differ by more than the rounding of their computation.

    >>> has_width(2.8, 3.2), has_width(0.012, 0.012), has_width(0.012, 0.012 + 4e-18), has_width(0.0, math.inf)
    (True, False, False, True)
    """
    width = high - low
    return not math.isfinite(width) or width > ROUNDING * max(abs(low), abs(high))


def interval_text(low: float, high: float, unit: str = "", *, missing: str = "") -> str:
    """An interval to the second significant digit of half its width, with its unit; ``missing`` if it has no width.

    >>> interval_text(2.812, 3.213, " K"), interval_text(0.012, 0.012, " mm", missing="–")
    ('2.81 to 3.21 K', '–')
    """
    half = (high - low) / 2
    return (
        f"{to_uncertainty(low, half)} to {to_uncertainty(high, half)}{unit}"
        if has_width(low, high)
        else missing
    )


def to_uncertainty(value: float | None, uncertainty: float) -> str:
    """A number to the second significant digit of its uncertainty; to three digits if that is unknown, '–' if missing.

    >>> to_uncertainty(0.03838123, 0.0013), to_uncertainty(332.951, 67), to_uncertainty(-44.13951, 0.83)
    ('0.0384', '333', '−44.14')
    >>> to_uncertainty(-5.91e-4, 5.8e-4), to_uncertainty(2.0, 0.0), to_uncertainty(None, 1.0)
    ('−5.9 × 10⁻⁴', '2', '–')
    >>> to_uncertainty(0.012, 2e-18)
    '0.012'
    """
    if not value or not (math.isfinite(value) and ROUNDING * abs(value) < uncertainty < math.inf):
        return number(value)
    last = math.floor(math.log10(uncertainty)) - 1
    if not 1e-3 <= abs(value) < 1e5:
        return number(value, max(math.floor(math.log10(abs(value))) - last + 1, 2))
    return f"{round(value, -last) + 0.0:.{max(-last, 0)}f}".replace("-", "−")


def to_interval(value: float, ci95: tuple[float, float]) -> str:
    """A number to the second significant digit of half its interval.

    >>> to_interval(2.9876, (2.812, 3.213))
    '2.99'
    """
    return to_uncertainty(value, (ci95[1] - ci95[0]) / 2)


def distinct_digits(low: float, high: float) -> int:
    """Significant digits, at least three, with which the ends of an interval differ.

    >>> distinct_digits(2.8, 3.2), distinct_digits(-3.0004, -2.9996), distinct_digits(1.0, 1.0)
    (3, 5, 3)
    """
    if low == high:
        return 3
    return next((n for n in range(3, 9) if number(low, n) != number(high, n)), 3)


def counts(value: float, *, sign: bool = False) -> str:
    """Encoder counts to a tenth, as an addition to a length or an angle; ``sign``: a plus sign if positive.

    >>> counts(7.66), counts(-0.02, sign=True), counts(0.58, sign=True), counts(-13.0, sign=True)
    ('7.7 counts', '0.0 counts', '+0.6 counts', '−13.0 counts')
    """
    rounded = round(value, 1) + 0.0
    return f"{rounded:{'+' if sign and rounded else ''}.1f} counts".replace("-", "−")


def raised(power: int) -> str:
    """An exponent in superscript digits.

    >>> raised(-3)
    '⁻³'
    """
    return str(power).translate(_RAISED)


def thousands(n: int) -> str:
    """An integer with thin spaces between thousands: 26 080."""
    return f"{n:,}".replace(",", "\u202f")


def runs_text(n: int) -> str:
    """A number of runs: "1 run", "3 runs"."""
    return f"{n} run" if n == 1 else f"{n} runs"


def duration(seconds: float) -> str:
    """A duration in a readable unit.

    >>> duration(43), duration(1700), duration(16400), duration(float("nan"))
    ('43 s', '28.3 min', '4.56 h', 'unknown')
    """
    if not math.isfinite(seconds):
        return "unknown"
    if seconds < 100:
        return f"{seconds:.3g} s"
    return f"{seconds / 60:.1f} min" if seconds < 7200 else f"{seconds / 3600:.2f} h"
