"""Who asks a run to stop, as its record keeps it."""

from enum import StrEnum


class Requester(StrEnum):
    """Kinds of those who ask. A signal does not tell its sender; Ctrl-C is taken for that of a person."""

    CONSOLE = "console"
    USER = "user"
    SIGNAL = "signal"
    PROGRAM = "program"

    @property
    def words(self) -> str:
        """In a sentence.

        >>> Requester("user").words
        'a person at the terminal'
        """
        return _WORDS[self]


_WORDS = {
    Requester.CONSOLE: "a console",
    Requester.USER: "a person at the terminal",
    Requester.SIGNAL: "a signal",
    Requester.PROGRAM: "a program",
}
