"""Numbers as a page prints them: few digits, a true minus sign, powers of ten written out. Knows no HTML."""

import math

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float | None, digits: int = 3) -> str:
    """A number with ``digits`` significant digits; '–' where there is none.

    >>> number(0.012345), number(-1.93e-4), number(None), number(12.5404), number(1234.5)
    ('0.0123', '−1.93 × 10⁻⁴', '–', '12.5', '1230')
    """
    if value is None or not math.isfinite(value):
        return "–"
    if value != 0 and not 1e-3 <= abs(value) < 1e5:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        return f"{mantissa} × 10{raised(int(exponent))}".replace("-", "−")
    text = f"{value:.{digits}g}"
    return (f"{float(text):.0f}" if "e" in text else text).replace("-", "−")


def raised(power: int) -> str:
    """An exponent in superscript digits.

    >>> raised(-3)
    '⁻³'
    """
    return str(power).translate(_RAISED)


def thousands(n: int) -> str:
    """A count with thin spaces: 26 080."""
    return f"{n:,}".replace(",", "\u202f")


def duration(seconds: float) -> str:
    """A duration for people.

    >>> duration(43), duration(1700), duration(16400), duration(float("nan"))
    ('43 s', '28.3 min', '4.56 h', 'unknown')
    """
    if not math.isfinite(seconds):
        return "unknown"
    if seconds < 100:
        return f"{seconds:.3g} s"
    return f"{seconds / 60:.1f} min" if seconds < 7200 else f"{seconds / 3600:.2f} h"
