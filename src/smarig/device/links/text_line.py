"""A line to an instrument that answers queries with lines of text, such as SCPI: a serial port or a TCP socket.

An answer does not identify its query. After a missing answer the line is therefore resynchronised: the host queries the
instrument's identity and discards everything before it. Answers come in the order of queries, so after as many
identities as were queried no earlier answer can follow. If an identity is lost, or the instrument has none, the line
must first stay quiet for QUIET time-outs.

A query that only reads is asked once more if it is not answered, or not by a reading. A command is never repeated:
nobody knows whether it was carried out.

A command waits for nothing: it is sent whatever state the line is in, because it may be the order of zero current. What
must wait, until the line is resynchronised, is the next query.
"""

import math
import time
from collections.abc import Callable
from typing import TypeVar

from smarig.core import UsageError
from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.device.links.port_url import (
    checked_url,
    close_port,
    error_of,
    refusal_of,
    send,
    send_at_once,
    unopened_port,
)
from smarig.device.links.query import only_reads, reading
from smarig.device.links.serial_port import PORT_ERRORS

QUIET = 8  # time-outs without a reply after which no answer can follow
# time-outs that a second attempt waits for the identity, and each attempt after one in which nothing came: a dead line
# is no reason to wait longer
SECOND_WAIT = 2
TRIES = 3  # queries of the identity on a line that still answers
CONTINUOUS = 2 * QUIET  # time-outs after which lines that go on answer nothing that was asked
LATE_LINES = 32  # largest number of lines discarded for one query
LONGEST = 256  # bytes of an answer
LINE_ENDS = {b"\n": "a line feed", b"\r\n": "CR LF", b"\r": "CR"}  # names for messages
_T = TypeVar("_T")


class TextLine:
    """The instrument is identified before anything else is asked. ``who``: the query that every such instrument answers
    with its name, not a number; "" for one that has none.

    ``url``: a serial port, tcp://HOST:PORT or rfc2217://HOST:PORT. ``line_end``: a reply ends with its last character.
    ``acknowledged``: the instrument answers each command ("OK"). ``repeats`` counts the queries asked once more,
    ``reconnections`` the times when a broken line was opened again.
    """

    def __init__(
        self,
        url: str,
        baud: int,
        timeout_s: float,
        who: str = "*IDN?",
        *,
        line_end: str = "\n",
        acknowledged: bool = False,
        serial_format: str = "8N1",
    ) -> None:
        self.where, self.identity = url, ""
        self.repeats = self.reconnections = 0
        self._who, self._acknowledged = who, acknowledged
        self._line_end, self._reply_end = line_end.encode(), line_end[-1].encode()
        self._late = True  # answers to earlier queries may still come
        self._dead = False  # no reply came to the last query of the identity
        self._identities = 0  # queried and not yet received
        self._heard = b""  # the incomplete line
        self._broken = self._closed = False
        self._timeout_s = timeout_s
        checked = checked_url(url)
        try:
            self._port = unopened_port(checked, baud, timeout_s, timeout_s, serial_format)
            self._port.open()
        except PORT_ERRORS as error:
            refused = refusal_of(url, error, baud, serial_format)
            raise Silent(f"{url} cannot be opened: {refused}") from None
        send_at_once(self._port)

    def identify(self) -> str:
        """The instrument's identity. Numbers before it answer queries of another process."""
        if not self._who:
            self._wait_for_quiet(QUIET)
            self.identity = f"instrument at {self.where}"
            return self.identity
        self._send(self._who)
        for _ in range(LATE_LINES):
            answer = self._answer(self._who)
            if not _is_number(answer):
                self.identity, self._late = self._last_of(answer), False
                return self.identity
        raise Garbled(
            f"{self.where} answers {self._who.strip()} with numbers instead of its identity. "
            f"{Garbled.remedy_at(self.where)}"
        )

    def _last_of(self, line: str) -> str:
        """The last line that comes. Acknowledgements of earlier commands look like an identity and come before it."""
        for _ in range(LATE_LINES if self._acknowledged else 0):
            if not (more := self._line(1)):
                break
            line = more
        return line

    def write(self, text: str) -> None:
        """Send a command at once, and once, on a line that is opened again first if it was broken.

        An acknowledgement is discarded. One that cannot be told from earlier answers, or that does not come in time, is
        no fault of the command: the next query is kept from taking it for its answer.
        """
        in_step = self._acknowledged and self._in_step()
        self._send(text)
        if self._acknowledged:
            self._late = not (in_step and self._line(1))

    def _in_step(self) -> bool:
        """Whether the next line can only be the answer to the next query."""
        try:
            return not (self._late or self._unasked())
        except Silent:
            return False

    def _send(self, text: str) -> None:
        if self._broken:
            self._reopen()
        try:
            send(self._port, text.encode() + self._line_end)
        except PORT_ERRORS as error:
            self._broken = not self._closed
            raise Silent(f"{self.where} cannot be written to: {error}. {Silent.remedy}") from None

    def ask(self, question: str, *, reads: bool | None = None) -> str:
        """The answer to this query and to no other. Raises Silent, Garbled.

        A command whose answer is of interest waits until the line is resynchronised, and is sent even if that fails.
        ``write`` sends it first: an order to zero.

        ``reads``: whether the instrument may be asked again, because the query changes nothing in it. By default its
        form tells: one word with a question mark at its end, and perhaps arguments (``MEAS:CURR? (@1)``).
        """
        return self._query_twice(question, reads, str)

    def number(self, question: str, *, reads: bool | None = None) -> float:
        """The answer as a number. Raises Garbled if it is not the number of a reading, twice."""
        return self._query_twice(question, reads, lambda answer: self._reading(question, answer))

    def _query_twice(self, question: str, reads: bool | None, meaning: Callable[[str], _T]) -> _T:
        """What the answer means, asked once more if there is none or it means nothing."""
        if self._who and question.strip() == self._who.strip():
            raise UsageError(
                f"{question.strip()} is the query of the identity of {self.where}, so its answer is discarded. If the "
                'instrument has no identity, open its line with who="".'
            )
        reads = only_reads(question) if reads is None else reads
        try:
            self._make_ready(QUIET)
        except (Silent, Garbled):
            if not reads:
                self._send(question)  # nobody can tell its answer, but it may be an order to zero
            raise
        try:
            return meaning(self._exchange(question))
        except (Silent, Garbled) as fault:
            if not reads:
                raise
            try:
                self._make_ready(SECOND_WAIT)
            except Silent:
                raise fault from None
        self.repeats += 1
        return meaning(self._exchange(question))

    def _reading(self, question: str, answer: str) -> float:
        number = reading(answer)
        if math.isnan(number):
            self._late = True  # it may be the answer to another query
            raise Garbled(
                f"{self.where} answers '{answer}' to {question.strip()}. {Garbled.remedy_at(self.where)}"
            )
        return number

    def close(self) -> None:
        """Close the port. Never raises."""
        self._broken, self._closed = False, True  # it stays closed
        close_port(self._port)

    def _make_ready(self, timeouts: int) -> None:
        """Nothing that was asked before can be taken for the next answer. A line found broken is opened again."""
        if not self.identity:
            self.identify()
        try:
            if self._late or self._unasked():
                self._resynchronise(timeouts)
        except Silent:
            if not self._broken:
                raise
            self._resynchronise(SECOND_WAIT)

    def _exchange(self, question: str) -> str:
        self._late = True
        self._send(question)
        for _ in range(LATE_LINES):
            answer = self._answer(question)
            if answer != self.identity:
                self._late = False
                return answer
        raise Garbled(
            f"{self.where} answers {question.strip()} only with its identity. {Garbled.remedy_at(self.where)}"
        )

    def _resynchronise(self, timeouts: int) -> None:
        """Query the identity until every such query is answered or certainly lost, which takes QUIET time-outs."""
        self._late = True
        if not self._who:
            self._wait_for_quiet(timeouts)
            return
        for _ in range(TRIES):
            self._send(self._who)
            self._identities += 1
            wait, end_s = SECOND_WAIT if self._dead else timeouts, self._latest_line_s()
            self._dead = True
            while self._identities and (line := self._line(wait)):
                self._dead, wait = False, timeouts
                self._identities -= line == self.identity
                if self._identities:
                    self._refuse_continuous_output(end_s)
            if not self._identities:
                self._late = False
                return
            if wait < QUIET:
                break
            self._identities = 0
            if self._dead:
                break
        raise Silent(f"{self.where} does not identify itself. {Silent.remedy}")

    def _wait_for_quiet(self, timeouts: int) -> None:
        """Discard lines until none has come for this number of time-outs."""
        end_s = self._latest_line_s()
        while self._line(timeouts):
            self._refuse_continuous_output(end_s)
        self._heard, self._late = b"", False

    def _latest_line_s(self) -> float:
        return time.monotonic() + CONTINUOUS * self._timeout_s

    def _refuse_continuous_output(self, end_s: float) -> None:
        """An instrument in continuous output sends lines for ever, and the host must not wait as long."""
        if time.monotonic() > end_s:
            raise Garbled(
                f"{self.where} goes on sending lines that nobody has queried. If it is set to continuous "
                f"output, switch that off at the instrument. {Garbled.remedy_at(self.where)}"
            )

    def _reopen(self) -> None:
        """Open a broken line again. On a serial port, answers to earlier queries may still come."""
        close_port(self._port)
        try:
            self._port.open()
        except PORT_ERRORS as error:
            raise Silent(
                f"{self.where} cannot be opened again: {error_of(self.where, error)}. {Silent.remedy}"
            ) from None
        if send_at_once(self._port):
            self._identities = 0  # those of another connection cannot come
        self._broken, self._late, self._heard = False, True, b""
        self.reconnections += 1

    def _answer(self, question: str) -> str:
        line = self._line(1)
        if not line:
            never_heard = "" if self.identity else f" {self._line_end_text()}"
            raise Silent(f"{self.where} does not answer {question.strip()}. {Silent.remedy}{never_heard}")
        return line

    def _line_end_text(self) -> str:
        """What may be wrong if nothing was ever understood."""
        name = LINE_ENDS.get(self._line_end, repr(self._line_end.decode()))
        if self._heard:
            return f"It sent something that does not end with {name}: set line_end of its link."
        return (
            f"If its lines do not end with {name}, set line_end of its link; if it takes longer than "
            f"{self._timeout_s:g} s to answer, timeout_s. Or the urls of two links are exchanged."
        )

    def _line(self, timeouts: int) -> str:
        """The next complete line that is not empty; "" if none arrives within this number of time-outs."""
        for _ in range(timeouts):
            try:
                self._heard = (self._heard + self._port.read_until(self._reply_end, LONGEST))[-LONGEST:]
            except PORT_ERRORS as error:
                raise self._unreadable(error) from None
            if self._heard.endswith(self._reply_end):
                line, self._heard = self._heard.decode("ascii", "replace").strip(), b""
                if line:
                    return line
        return ""

    def _unasked(self) -> bool:
        """Whether something arrived that was not queried. The rest of a reply's end, as the LF of CR LF, is nothing."""
        try:
            while not self._heard.strip() and self._port.in_waiting:
                self._heard = self._port.read(1)
        except PORT_ERRORS as error:
            raise self._unreadable(error) from None
        return bool(self._heard.strip())

    def _unreadable(self, error: BaseException) -> Silent:
        self._broken = not self._closed
        return Silent(f"{self.where} cannot be read: {error}. {Silent.remedy}")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
