"""A serial line to an instrument that answers queries with lines of text, such as SCPI.

An answer does not identify its query. After a missing answer the line is therefore resynchronised: the host queries the
instrument's identity and discards everything before it. Answers come in the order of queries, so after as many
identities as were queried no earlier answer can follow. If an identity is lost, the line must first stay quiet for
QUIET time-outs.
"""

import contextlib
import math

import serial

from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.device.links.serial_port import PORT_ERRORS

QUIET = 8  # time-outs without a reply after which no answer can follow
TRIES = 3  # queries of the identity on a line that still answers
LATE_LINES = 32  # largest number of lines discarded for one query
LONGEST = 256  # bytes of an answer


class TextLine:
    """Call ``identify`` first. ``who``: the query that every such instrument answers with its name, not a number."""

    def __init__(self, url: str, baud: int, timeout_s: float, who: str = "*IDN?") -> None:
        self.where, self.identity = url, ""
        self._who = who
        self._late = True  # answers to earlier queries may still come
        self._identities = 0  # queried and not yet received
        self._heard = b""  # the incomplete line
        try:
            self._port = serial.serial_for_url(url, baud, timeout=timeout_s, write_timeout=timeout_s)
        except PORT_ERRORS as error:
            raise Silent(f"{url} cannot be opened: {error}. {Silent.remedy}") from None

    def identify(self) -> str:
        """The instrument's identity. Numbers before it answer queries of another process."""
        self.write(self._who)
        for _ in range(LATE_LINES):
            answer = self._answer(self._who)
            if math.isnan(_number(answer)):
                self.identity, self._late = answer, False
                return answer
        raise Garbled(
            f"{self.where} answers {self._who} with numbers instead of its identity. {Garbled.remedy}"
        )

    def write(self, text: str) -> None:
        """Send a line that has no answer."""
        try:
            self._port.write(f"{text}\n".encode())
        except PORT_ERRORS as error:
            raise Silent(f"{self.where} cannot be written to: {error}. {Silent.remedy}") from None

    def ask(self, question: str) -> str:
        """The answer to this query and to no other. Raises Silent, Garbled."""
        if self._late or self._unasked():
            self._resynchronise()
        self._late = True
        self.write(question)
        for _ in range(LATE_LINES):
            answer = self._answer(question)
            if answer != self.identity:
                self._late = False
                return answer
        raise Garbled(f"{self.where} answers {question} only with its identity. {Garbled.remedy}")

    def number(self, question: str) -> float:
        """The answer as a number. Raises Garbled if it is not a number."""
        answer = self.ask(question)
        if math.isfinite(number := _number(answer)):
            return number
        self._late = True
        raise Garbled(f"{self.where} answers '{answer}' to {question}. {Garbled.remedy}")

    def close(self) -> None:
        """Close the port. Never raises."""
        with contextlib.suppress(*PORT_ERRORS):
            self._port.close()

    def _resynchronise(self) -> None:
        """Query the identity until every such query is answered or certainly lost."""
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
        raise Silent(f"{self.where} does not identify itself. {Silent.remedy}")

    def _answer(self, question: str) -> str:
        line = self._line(1)
        if not line:
            raise Silent(f"{self.where} does not answer {question}. {Silent.remedy}")
        return line

    def _line(self, timeouts: int) -> str:
        """The next complete line that is not empty; "" if none arrives within this number of time-outs."""
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
        """Whether something arrived that was not queried."""
        try:
            return bool(self._heard or self._port.in_waiting)
        except PORT_ERRORS as error:
            raise Silent(f"{self.where} cannot be read: {error}. {Silent.remedy}") from None


def _number(text: str) -> float:
    """The number, or NaN."""
    try:
        return float(text)
    except ValueError:
        return math.nan
