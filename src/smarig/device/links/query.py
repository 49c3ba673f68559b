"""The form of lines of text: which query may be sent once more, and which answer is a reading."""

import math

from smarig.core import number_from_text

LARGEST = (
    2.0**53
)  # from here on a number no longer tells its units; 9.9E37 of SCPI means that there is no reading


def only_reads(line: str) -> bool:
    """Whether a line is one query, which changes nothing in the instrument.

    Not so: several commands in one line, a command that is acknowledged, and the common queries of IEEE 488.2 besides
    the identity, which clear a register or start a test.

    >>> [only_reads(line) for line in ("MEAS:CURR? (@1)", "*IDN?", "CURR 1;CURR?", "SET 1", "*ESR?")]
    [True, True, False, False, False]
    """
    words = line.split()
    if not words or ";" in line or not words[0].endswith("?"):
        return False
    return not words[0].startswith("*") or words[0].upper() == "*IDN?"


def reading(answer: str) -> float:
    """The number of an answer; NaN if it is none that a reading can be.

    >>> [reading(answer) for answer in ("0.5", "ERR 42", "inf", "9.91E37", 30 * "9", "1_0")]
    [0.5, nan, nan, nan, nan, nan]
    """
    try:
        number = number_from_text(answer)
    except ValueError:
        return math.nan
    return number if abs(number) < LARGEST else math.nan
