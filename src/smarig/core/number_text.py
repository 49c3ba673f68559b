"""Reads a number from a text of a data file: ASCII digits only."""


def number_from_text(text: str) -> float:
    """The number. Raises ValueError for what only Python takes for a number: ``1_000``, full-width and Arabic digits.

    >>> number_from_text("-1.5e3")
    -1500.0
    >>> number_from_text("1_000")
    Traceback (most recent call last):
    ValueError: not a number: '1_000'
    """
    if "_" in text or not text.isascii():
        raise ValueError(f"not a number: {text!r:.60}")
    return float(text)
