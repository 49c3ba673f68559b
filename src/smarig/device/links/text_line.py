"""A serial line to an instrument that answers questions with lines of text, as SCPI does.

Such answers do not say which question they answer. So after a missing answer the line is resynchronised: the instrument
is asked who it is, and all that comes before is thrown away. Answers come in the order of questions, so with as many
identities heard as were asked for, no earlier answer can follow. Where one is lost, the line must have been quiet for
QUIET timeouts first.
"""

import contextlib
import math

import serial

from smarig.device.links.serial_line import PORT_ERRORS
from smarig.device.wire.link_faults import Garbled, Silent

QUIET = 8  # timeouts without a word after which no answer comes any more
TRIES = 3  # of asking who it is, where the line is alive
LATE_LINES = 32  # thrown away at most for one question
LONGEST = 256  # bytes of an answer


class TextLine:
    """``identify`` first; ``who``: the question that any such instrument answers with its name, never with a number."""

    def __init__(self, url: str, baud: int, timeout_s: float, who: str = "*IDN?") -> None:
        self.where, self.identity = url, ""
        self._who = who
        self._late = True  # answers to earlier questions may still come
        self._identities = 0  # that were asked for and have not come
        self._heard = b""  # of a line that is not whole
        try:
            self._port = serial.serial_for_url(url, baud, timeout=timeout_s, write_timeout=timeout_s)
        except PORT_ERRORS as error:
            raise Silent(f"{url} cannot be opened: {error}. {Silent.remedy}") from None

    def identify(self) -> str:
        """What it says of itself; numbers before it were asked for by another process."""
        self.write(self._who)
        for _ in range(LATE_LINES):
            answer = self._answer(self._who)
            if math.isnan(_number(answer)):
                self.identity, self._late = answer, False
                return answer
        raise Garbled(f"{self.where} answers numbers to {self._who}. {Garbled.remedy}")

    def write(self, text: str) -> None:
        """A line that is not answered."""
        try:
            self._port.write(f"{text}\n".encode())
        except PORT_ERRORS as error:
            raise Silent(f"{self.where} cannot be written to: {error}. {Silent.remedy}") from None

    def ask(self, question: str) -> str:
        """The answer to this question, and to no other. Raises Silent, Garbled."""
        if self._late or self._unasked():
            self._resynchronise()
        self._late = True
        self.write(question)
        for _ in range(LATE_LINES):
            answer = self._answer(question)
            if answer != self.identity:
                self._late = False
                return answer
        raise Garbled(f"{self.where} answers nothing but its name to {question}. {Garbled.remedy}")

    def number(self, question: str) -> float:
        """The same as a number; Garbled where it is none."""
        answer = self.ask(question)
        if math.isfinite(number := _number(answer)):
            return number
        self._late = True
        raise Garbled(f"{self.where} answers '{answer}' to {question}. {Garbled.remedy}")

    def close(self) -> None:
        """Let go of the port; never raises."""
        with contextlib.suppress(*PORT_ERRORS):
            self._port.close()

    def _resynchronise(self) -> None:
        """Ask who it is until every such question is answered, or lost for sure."""
        self._late = True
        for _ in range(TRIES):
            self.write(self._who)
            self._identities += 1
            heard = 0
            while self._identities and (line := self._line(QUIET)):
                heard += 1
                self._identities -= line == self.identity
            if not self._identities:
                self._late = False
                return
            self._identities = 0
            if not heard:
                break
        raise Silent(f"{self.where} does not say who it is. {Silent.remedy}")

    def _answer(self, question: str) -> str:
        line = self._line(1)
        if not line:
            raise Silent(f"{self.where} gives no answer to {question}. {Silent.remedy}")
        return line

    def _line(self, timeouts: int) -> str:
        """The next whole line that is not empty; "" where none comes in so many timeouts."""
        for _ in range(timeouts):
            try:
                self._heard = (self._heard + self._port.read_until(b"\n", LONGEST))[-LONGEST:]
            except PORT_ERRORS as error:
                raise Silent(f"{self.where} cannot be read: {error}. {Silent.remedy}") from None
            if self._heard.endswith(b"\n"):
                line, self._heard = self._heard.decode("ascii", "replace").strip(), b""
                if line:
                    return line
        return ""

    def _unasked(self) -> bool:
        """Whether something came that nobody asked for."""
        try:
            return bool(self._heard or self._port.in_waiting)
        except PORT_ERRORS as error:
            raise Silent(f"{self.where} cannot be read: {error}. {Silent.remedy}") from None


def _number(text: str) -> float:
    """NaN where it is none."""
    try:
        return float(text)
    except ValueError:
        return math.nan
