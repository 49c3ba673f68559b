"""Tells from its form whether a line of text only reads, so that it may be sent once more when it is not answered."""


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
