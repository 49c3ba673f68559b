"""Units as they are written behind numbers and in sentences. A quantity without unit has the unit "1" or none."""


def spaced(unit: str) -> str:
    """A unit behind a number, with the space between them; nothing for a quantity without unit.

    >>> f"rms 0.07{spaced('mm')}, rms 0.07{spaced('1')}"
    'rms 0.07 mm, rms 0.07'
    """
    return f" {unit}" if unit not in ("", "1") else ""


def in_unit(unit: str) -> str:
    """A unit in a sentence: "in 'mm'", or "without unit".

    >>> in_unit("mm"), in_unit("1")
    ("in 'mm'", 'without unit')
    """
    return f"in '{unit}'" if spaced(unit) else "without unit"
