"""A meter that answers one query by VISA, as a position, temperature or force: scale × answer + offset."""

import math

from smarig.config import LinkFile, RigFile
from smarig.core import NAN, TomlTable
from smarig.device.drivers._driver_settings import settings_of
from smarig.device.encoding.link_faults import WrongDevice
from smarig.device.links.query import reading
from smarig.device.links.visa_line import Backend, VisaLine
from smarig.device.polled.from_functions import FunctionInput

_OVERFLOW = 1e30  # meters answer 9.9E37 for an overload


class VisaMeterSettings(TomlTable):
    """[links.DEVICE.settings] of visa_meter."""

    identity: str = ""  # a part of its answer to *IDN?: another instrument is refused
    query: str = "READ?"  # answered by a number
    answer_unit: str = ""  # after that number, as in "12.5 mm"; by default that of the first answer
    unit: str = ""  # of a position: "count", "mm" or "deg"
    scale: float = 1.0  # of the answer, in the unit of the role (mm, deg, °C, N)
    offset: float = 0.0  # added afterwards
    low: float = -math.inf  # a reading below is none: out of range
    high: float = math.inf  # a reading above is none
    prepare: tuple[str, ...] = ()  # commands sent once
    absolute: bool = False  # the zero of a position survives a restart: a laser, not a counter
    backend: Backend = ""


def visa_meter(where: LinkFile, rig: RigFile) -> FunctionInput:
    """The meter at a VISA address."""
    del rig
    settings = settings_of(where, VisaMeterSettings)
    line = VisaLine.of(where, settings.backend)
    try:
        if settings.identity not in (answer := line.identify()) or math.isfinite(reading(answer)):
            raise WrongDevice(
                f"The device at {where.url} answers '{answer}' to *IDN?, "
                + (f"without '{settings.identity}'" if settings.identity else "which is no identity")
                + ": the urls of two links may be exchanged."
            )
        if settings.answer_unit:
            line.expect_unit(settings.query, settings.answer_unit)
        for command in settings.prepare:
            line.write(command)
    except BaseException:
        line.close()
        raise

    def read() -> float:
        answer = line.number(settings.query)
        value = settings.scale * answer + settings.offset
        return value if abs(answer) < _OVERFLOW and settings.low <= value <= settings.high else NAN

    return FunctionInput(line.identity, read, settings.unit, line.close, line, settings.absolute)
