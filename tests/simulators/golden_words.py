"""Definitions shared by the golden scripts: states, orders, faults, settings, frames and lines by hand."""

from golden import Script

from smarig.device.encoding.crc import crc16

OFF, ARMED, TRIPPED = 0, 1, 2
NONE, ARM, SWITCH_OFF, REARM = 0, 1, 2, 3
LEASE, OVER_CURRENT, SLEW, HEAT, SHORT, RESISTANCE, OPEN, STOP = 1, 2, 3, 4, 5, 6, 7, 8
WIRE_TEMPERATURE = 9
NO_SENSOR = -32768
AMPERE = 1_000_000
SAFE_CRC = crc16(  # of the settings at boot, word for word
    bytes.fromhex("0064 01F4 0000 0000 0000 0000 0000 03E8 0000 0000 000F 4240 0000 0001 03E8")
)
WIRE = {  # one tick of 0.1 s, lease of five ticks, 0 … 1 A, 2.5 A per tick, 1 … 20 ohm, 2 A²s that settle in 10 s
    "period": 100,
    "lease": 500,
    "current_max": AMPERE,
    "slew_max": 25_000,
    "resistance_min": 1000,
    "resistance_max": 20_000,
    "heat_max": 2_000_000,
    "heat_settle": 10_000,
}


def frame(text: str) -> str:
    """Hexadecimal bytes with their check word, low byte first."""
    body = bytes.fromhex(text)
    return (body + crc16(body).to_bytes(2, "little")).hex()


def line(text: str) -> str:
    """A line with its check word."""
    return f"{text} *{crc16(text.encode('latin-1')):04X}"


def armed(name: str, framing: str, title: str, **settings: int) -> Script:
    """An amplifier that was set up and armed."""
    s = Script(name, "amplifier", framing, title)
    s.settings("settings", **(WIRE | settings))
    s.command("arm", ORDER=ARM, state=ARMED, output=0)
    return s


def good(s: Script, current_uA: int = AMPERE, times: int = 1) -> None:
    """Ticks in which nothing is wrong: 5 ohm."""
    s.tick(current_uA, 5 * current_uA, NO_SENSOR, 0, times=times)
