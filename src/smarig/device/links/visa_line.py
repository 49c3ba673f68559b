"""A line to an instrument by VISA: USB-TMC, LAN, GPIB or serial, through PyVISA (extra ``visa``).

An answer does not identify its query. After anything went wrong the session is closed, opened again and identified, so
that a late answer of the old session is never taken for another. A query that only reads is asked once more if
it is not answered, or not by a number; a command never.

An order to zero waits for no answer: it is sent over a session that was opened again before the instrument has
identified itself, which the next query waits for.
"""

import contextlib
import re
import socket
from collections.abc import Callable
from typing import Any, Literal, NoReturn, Self, TypeVar

from smarig.config import LinkFile
from smarig.core import MissingExtra, UsageError, error_text
from smarig.device.encoding.link_faults import Garbled, Silent, WrongDevice
from smarig.device.links.query import LARGEST, only_reads

# of PyVISA; empty: that of ~/.pyvisarc, the vendor's library if there is one, else pyvisa-py. No path: a rig file that
# came from elsewhere would load a library.
Backend = Literal["", "@ivi", "@py", "@sim"]
_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)")  # and the text after it
# 1,234: no two numbers of an instrument are so written
_DECIMAL_COMMA = re.compile(r"\s*[-+]?\d+,\d+\s*[^\d,]*")
_IDENTITY = "*IDN?"
_SWITCH = {"1": True, "ON": True, "0": False, "OFF": False}
_T = TypeVar("_T")


class VisaLine:
    """``resource`` is a VISA address such as TCPIP0::192.168.1.20::INSTR; ``backend`` is that of PyVISA ("@py")."""

    @classmethod
    def of(cls, where: LinkFile, backend: str) -> Self:
        """The session of a link."""
        return cls(
            where.url,
            where.timeout_s,
            backend=backend,
            baud=where.baud,
            line_end=where.line_end,
            serial_format=where.serial_format,
        )

    def __init__(
        self,
        resource: str,
        timeout_s: float,
        *,
        backend: str = "",
        baud: int = 115200,
        line_end: str = "\n",
        serial_format: str = "8N1",
    ) -> None:
        self.where, self.identity = resource, ""
        self._timeout_ms, self._baud, self._line_end = round(1000 * timeout_s), baud, line_end
        self._serial_format = serial_format
        self._manager = _manager(backend)
        self._session: Any = None
        self._units: dict[str, list[str]] = {}  # of the numbers that answer a query
        self._verified = True  # the instrument of this session has identified itself, or nobody knows it yet
        self.reconnections = self.repeats = 0  # sessions opened again; queries asked once more
        self._open()

    def identify(self) -> str:
        """The answer to *IDN?. Raises WrongDevice if another instrument answers than before."""
        found = self._query(_IDENTITY)
        if self.identity and found != self.identity:
            self._drop()
            raise WrongDevice(f"'{found}' answers at {self.where} instead of '{self.identity}'.")
        self.identity = found
        return found

    def write(self, text: str, *, at_once: bool = False) -> None:
        """Send a command without an answer. ``at_once``: an order to zero, which does not wait until the instrument of
        a session that was opened again is known to be the same.
        """
        session = self._usable(verified=not at_once)
        try:
            session.write(text)
        except Exception as error:
            self._fail(error, text)

    def ask(self, question: str, *, reads: bool | None = None) -> str:
        """The answer to a query. ``reads``: whether it may be asked again; by default its form tells (only_reads)."""
        return self._query_twice(question, reads, str)

    def switched_on(self, question: str) -> bool:
        """Whether the answer to a query that only reads says on. Raises Garbled if it says neither, twice."""
        return self._query_twice(question, True, lambda answer: self._switch(question, answer))

    def expect_unit(self, question: str, unit: str) -> None:
        """Take the number of this query only in this unit, as the instrument writes it."""
        self._units[question] = [unit]

    def number(self, question: str, *, reads: bool | None = None) -> float:
        """The first number of the answer. Raises Garbled without one, twice."""
        return self.numbers(question, reads=reads)[0]

    def numbers(self, question: str, *, reads: bool | None = None) -> list[float]:
        """All numbers of an answer, which commas separate. Raises Garbled if one is none, twice.

        The unit after a number is that of the first answer, or of ``expect_unit``: an instrument that was set to
        inches, or changes to mV, does not pass as before.
        """
        return self._query_twice(question, reads, lambda answer: self._readings(question, answer))

    def _query_twice(self, question: str, reads: bool | None, meaning: Callable[[str], _T]) -> _T:
        """What the answer means, asked once more if there is none or it means nothing."""
        self._usable()
        try:
            return meaning(self._query(question))
        except (Silent, Garbled):
            if not (only_reads(question) if reads is None else reads):
                raise
        self._usable()
        self.repeats += 1
        return meaning(self._query(question))

    def _readings(self, question: str, answer: str) -> list[float]:
        found = [_NUMBER.match(part) for part in answer.split(",")]
        parts = [part.groups() for part in found if part]
        if len(parts) < len(found) or _DECIMAL_COMMA.fullmatch(answer):
            self._garbled(question, answer)
        numbers, units = [float(number) for number, _ in parts], [unit.strip() for _, unit in parts]
        if max(map(abs, numbers)) >= LARGEST:  # 9.9E37, an overload, which some write without a unit
            return numbers
        if (before := self._units.setdefault(question, units)) != units:
            in_unit = f"in {', '.join(before)}" if any(before) else "without a unit"
            self._drop()
            raise Garbled(
                f"{self.where} answers '{answer}' to {question.strip()}, where a number {in_unit} is expected. Set its "
                "unit and a fixed range."
            )
        return numbers

    def _switch(self, question: str, answer: str) -> bool:
        if answer.upper() not in _SWITCH:
            self._garbled(question, answer)
        return _SWITCH[answer.upper()]

    def _garbled(self, question: str, answer: str) -> NoReturn:
        self._drop()
        raise Garbled(
            f"{self.where} answers '{answer}' to {question.strip()}. {Garbled.remedy_at(self.where)}"
        )

    def close(self) -> None:
        """Close the session. Never raises."""
        self._drop()
        with contextlib.suppress(Exception):
            self._manager.close()

    def _query(self, question: str) -> str:
        session = self._session
        try:
            return str(session.query(question)).strip()
        except Exception as error:
            self._fail(error, question)
            raise  # not reached

    def _usable(self, *, verified: bool = True) -> Any:
        """The session, opened again after a fault, and identified if it must be."""
        if self._session is None:
            self._open()
            self._verified = not self.identity
        if verified and not self._verified:
            self.identify()
            self._verified = True
            self.reconnections += 1
        return self._session

    def _open(self) -> None:
        try:
            self._session = self._manager.open_resource(
                self.where,
                open_timeout=self._timeout_ms,
                read_termination=self._line_end[-1],
                write_termination=self._line_end,
            )
            self._session.timeout = self._timeout_ms
            self._without_delay()
            if self.where.upper().startswith("ASRL"):
                self._session.baud_rate = self._baud
                self._set_serial_format()
        except Exception as error:
            self._drop()
            if not _is_visa_address(self.where):
                raise UsageError(
                    f"'{self.where}' is no VISA address, such as TCPIP0::192.168.1.20::INSTR or "
                    "USB0::0x2A8D::0x1301::MY57501234::INSTR."
                ) from None
            raise Silent(f"{self.where} cannot be opened: {error_text(error)}. {Silent.remedy}") from None

    def _set_serial_format(self) -> None:
        """Data bits, parity and stop bits of a serial port."""
        from pyvisa.constants import Parity, StopBits

        letters = {"N": Parity.none, "E": Parity.even, "O": Parity.odd, "M": Parity.mark, "S": Parity.space}
        stop = {"1": StopBits.one, "1.5": StopBits.one_and_a_half, "2": StopBits.two}
        form = self._serial_format
        self._session.data_bits = int(form[0])
        self._session.parity, self._session.stop_bits = letters[form[1]], stop[form[2:]]

    def _without_delay(self) -> None:
        """On a TCP socket: a query is not held back until the command before it is acknowledged, which takes 40 ms.

        Libraries of vendors send at once; pyvisa-py does not, and cannot set the attribute for it.
        """
        sessions = getattr(self._manager.visalib, "sessions", {})
        line = getattr(sessions.get(self._session.session), "interface", None)
        if isinstance(line, socket.socket):
            line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _fail(self, error: Exception, what: str) -> None:
        self._drop()
        never_heard = "" if self.identity else " Or the urls of two links are exchanged."
        raise Silent(
            f"{self.where} does not answer {what.strip()}: {error_text(error)}. {Silent.remedy}{never_heard}"
        ) from None

    def _drop(self) -> None:
        session, self._session = self._session, None
        if session is not None:
            with contextlib.suppress(Exception):
                session.close()


def _is_visa_address(where: str) -> bool:
    """Whether it has the form of one; a vendor's library also opens names of its own, which have not."""
    from pyvisa.rname import InvalidResourceName, ResourceName

    try:
        ResourceName.from_string(where)
    except InvalidResourceName:
        return False
    return True


def _manager(backend: str) -> Any:
    """The resource manager of PyVISA. Raises UsageError without the extra or the backend."""
    try:
        import pyvisa
    except ImportError:
        raise MissingExtra("A VISA instrument", "visa") from None
    try:
        return pyvisa.ResourceManager(backend)
    except Exception as error:
        raise UsageError(f"PyVISA cannot use the backend '{backend}': {error_text(error)}.") from None
