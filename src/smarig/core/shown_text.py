"""Texts from files as they are shown in messages: printable, and not longer than a reader can use."""

import unicodedata
from typing import Any

LONGEST_MESSAGE = 4000
LONGEST_LINE = 1000  # of what another program says
_KEPT = "\n\t"
_HIDDEN = ("Cc", "Cf", "Cs", "Co", "Zl", "Zp")  # control and formatting characters, halves of characters


def printable(text: str, longest: int = LONGEST_MESSAGE) -> str:
    r"""The text without characters that a terminal would execute, and with its middle left out if it is too long.

    >>> printable("\x1b[2Jdone")
    '\\x1b[2Jdone'
    >>> printable("a" * 5000, 11)
    'aaaa … aaaa'
    """
    if len(text) > longest:
        half = max((longest - 3) // 2, 1)
        text = f"{text[:half]} … {text[-half:]}"
    if text.isprintable():
        return text
    return "".join(c if c in _KEPT or unicodedata.category(c) not in _HIDDEN else _escaped(c) for c in text)


def has_control_characters(text: str) -> bool:
    r"""Whether a text holds characters that no name, path or address has.

    >>> has_control_characters("a\0b"), has_control_characters("/dev/ttyÜ 1")
    (True, False)
    """
    return any(unicodedata.category(c) == "Cc" for c in text)


def shown(value: Any, longest: int = 80) -> str:
    """A value in a message, as Python writes it, on one line.

    >>> shown("x" * 100, 21)
    "'xxxxxxxx … xxxxxxxx'"
    """
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # integers of many digits, structures of many levels
        return "a value too long to show"
    except Exception:  # of a class that does not show itself
        return f"a value of type {type(value).__name__}"
    return printable(text, longest)


def one_line(text: str, longest: int = LONGEST_LINE) -> str:
    r"""The text of another program on one line.

    >>> one_line(" over\ntemperature\x1b[2J \r\n")
    'over temperature\\x1b[2J'
    """
    return printable(" ".join(text.split()), longest)


def error_text(error: BaseException) -> str:
    """Type and message of an error of another library, in one line without a full stop.

    >>> error_text(OSError("no such\\n device."))
    'OSError: no such device'
    """
    try:
        message = str(error)
    except Exception:  # of a class that says nothing of itself
        message = ""
    return one_line(f"{type(error).__name__}: {message}").rstrip(".: ")


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")
