"""Golden scripts of the protection of the wire: lease, trips, heat. Figures are computed by hand."""

from golden import Script
from golden_words import (
    AMPERE,
    ARM,
    ARMED,
    HEAT,
    LEASE,
    NO_SENSOR,
    OFF,
    OPEN,
    OVER_CURRENT,
    REARM,
    RESISTANCE,
    SHORT,
    SLEW,
    STOP,
    SWITCH_OFF,
    TRIPPED,
    WIRE,
    WIRE_TEMPERATURE,
    armed,
    good,
)

from smarig.device.encoding.crc import crc16
from smarig.device.encoding.exchange import Exchange


def lease() -> Script:
    s = armed(
        "amplifier_lease", "lines", "Lease 500 ms, ticks of 100 ms: fed after tick k, tripped in tick k + 6."
    )
    s.command("1 A", CURRENT=AMPERE, output=AMPERE, lease_left=500)
    good(s, times=4)
    s.ask("reading does not feed", Exchange(0, 0x14), state=ARMED, tick=4, lease_left=100)
    s.command("nor does what is refused", ORDER=ARM, refused=4)
    good(s)
    s.ask("five ticks without a word", Exchange(0, 0x14), state=ARMED, output=AMPERE, lease_left=0, tick=5)
    good(s)
    s.ask("the sixth trips", Exchange(0, 0x14), state=TRIPPED, trip=LEASE, output=0, lease_left=0, tick=6)
    s.command("a trip is latched", state=TRIPPED, trip=LEASE)
    s.command("a current while tripped", CURRENT=1, refused=4)
    s.command("arm while tripped", ORDER=ARM, refused=4)
    s.command(
        "the sample of the trip is marked", RING_NEXT=6, RING_WANT=1, read=0x21, ring_first=6, ring_count=1
    )
    s.command("rearm", ORDER=REARM, state=ARMED, trip=0, output=0, lease_left=500)
    s.command("off", ORDER=SWITCH_OFF, state=OFF)
    slow = WIRE | {"period": 200, "slew_max": 12_500}
    s.settings("ticks of 200 ms: 2.5 ticks of lease are 3", **slow)
    s.command("arm", ORDER=ARM, lease_left=600)
    s.tick(0, 0, NO_SENSOR, 0, times=3)
    s.ask("three are not too many", Exchange(0, 0x14), state=ARMED)
    s.tick(0, 0, NO_SENSOR, 0)
    s.ask("four are", Exchange(0, 0x14), state=TRIPPED, trip=LEASE)
    s.settings("settings while tripped; a tick of half the lease is the longest", **(WIRE | {"period": 250}))
    s.command("off after a trip clears it", ORDER=SWITCH_OFF, state=OFF, trip=0)
    s.command("then arm", ORDER=ARM, state=ARMED, lease_left=500)
    s.tick(0, 0, NO_SENSOR, 0, times=2)
    s.ask("two ticks at least", Exchange(0, 0x14), state=ARMED, lease_left=0)
    s.tick(0, 0, NO_SENSOR, 0)
    s.ask("three are too many", Exchange(0, 0x14), state=TRIPPED, trip=LEASE)
    return s


def driving(name: str, title: str) -> Script:
    """Armed and at 1 A, with no limit of heat."""
    s = armed(name, "rtu", title, heat_max=2**32 - 1)
    s.command("1 A", CURRENT=AMPERE, output=AMPERE)
    return s


def tripped(s: Script, cause: int, why: str) -> None:
    """It has, and is re-armed."""
    s.ask(why, Exchange(0, 0x14), state=TRIPPED, trip=cause, output=0)
    s.command("rearm, 1 A", ORDER=REARM, CURRENT=AMPERE, state=ARMED, trip=0, output=AMPERE)


def holds(s: Script, why: str) -> None:
    """It has not, and is fed."""
    s.command(why, CURRENT=AMPERE, state=ARMED, output=AMPERE)


def trips() -> Script:
    s = driving("amplifier_trips", "The stop input and over-current, to the microampere.")
    s.tick(AMPERE, 5 * AMPERE, 2000, 1)
    holds(s, "saturation alone is no fault")
    s.tick(AMPERE, 5 * AMPERE, NO_SENSOR, 2)
    tripped(s, STOP, "the stop input")
    s.tick(1_050_000, 5_250_000, NO_SENSOR, 0)
    s.tick(-50_000, -250_000, NO_SENSOR, 0)
    holds(s, "5 % beyond the limits is allowed")
    s.tick(1_050_001, 5_250_000, NO_SENSOR, 0)
    tripped(s, OVER_CURRENT, "1 µA more is not")
    s.tick(-50_001, 0, NO_SENSOR, 0)
    tripped(s, OVER_CURRENT, "nor below")
    s.command("off", ORDER=SWITCH_OFF, state=OFF)
    s.tick(5 * AMPERE, 0, NO_SENSOR, 2, times=3)
    s.ask("nothing trips that is off", Exchange(0, 0x14), state=OFF, trip=0)
    return s


def contacts() -> Script:
    s = driving("amplifier_contacts", "Open, short, resistance: three ticks in a row, to the microvolt.")
    s.tick(499_999, 2_500_000, NO_SENSOR, 0, times=2)
    s.tick(500_000, 2_500_000, NO_SENSOR, 0)
    s.tick(499_999, 2_500_000, NO_SENSOR, 0, times=2)
    holds(s, "less than half, but never three ticks in a row")
    s.tick(499_999, 2_500_000, NO_SENSOR, 0)
    tripped(s, OPEN, "the third in a row: open")
    s.tick(AMPERE, 1_000_000, NO_SENSOR, 0, times=3)
    holds(s, "just resistance_min")
    s.tick(AMPERE, -999_999, NO_SENSOR, 0, times=3)
    tripped(s, SHORT, "1 µV less for three ticks, whatever its sign")
    s.tick(AMPERE, 20_000_000, NO_SENSOR, 0, times=3)
    holds(s, "just resistance_max")
    s.tick(AMPERE, 20_000_001, NO_SENSOR, 0, times=3)
    tripped(s, RESISTANCE, "1 µV more for three ticks")
    s.command("49.999 mA", CURRENT=49_999, output=49_999)
    s.tick(0, 0, NO_SENSOR, 0, times=3)
    s.command("so little is not open", CURRENT=49_999, state=ARMED)
    s.tick(49_999, 0, NO_SENSOR, 0, times=3)
    s.command("nor short", CURRENT=AMPERE, state=ARMED)
    s.tick(400_000, 0, NO_SENSOR, 0, times=3)
    tripped(s, OPEN, "open and short at once: open comes first")
    s.tick(400_000, 0, NO_SENSOR, 2)
    tripped(s, STOP, "stop comes before all")
    return s


WIRE_WORDS = (
    "0064 01F4 0000 0000 000F 4240 0000 61A8 0000 03E8 0000 4E20 FFFF FFFF 2710"  # with all heat allowed
)


def wire_temperature() -> Script:
    s = driving("amplifier_wire_temperature", "The limit of the measured wire temperature, to 0.01 °C.")
    s.ask("no limit: the check word of map version 4", Exchange(0x14, 1), settings_crc=crc(WIRE_WORDS))
    s.tick(AMPERE, 5 * AMPERE, 32767, 0)
    holds(s, "no limit")
    s.command("off", ORDER=SWITCH_OFF, state=OFF)
    limited = WIRE | {"heat_max": 2**32 - 1, "wire_temperature_max": 9000}
    s.settings("at most 90 °C", **limited)
    s.ask("the check word with the limit", Exchange(0x14, 1), settings_crc=crc(WIRE_WORDS + "2328"))
    s.command("arm, 1 A", ORDER=ARM, CURRENT=AMPERE, state=ARMED, output=AMPERE)
    s.tick(AMPERE, 5 * AMPERE, 9000, 0)
    holds(s, "just the limit")
    s.tick(AMPERE, 5 * AMPERE, 9001, 0)
    s.ask("one hundredth more", Exchange(0, 0x14), state=TRIPPED, trip=WIRE_TEMPERATURE, output=0)
    s.tick(0, 0, 2000, 0, times=3)
    s.command("cold again: a trip is latched", state=TRIPPED, trip=WIRE_TEMPERATURE)
    s.command("a current while tripped", CURRENT=1, refused=4)
    s.command("rearm, 1 A", ORDER=REARM, CURRENT=AMPERE, state=ARMED, trip=0, output=AMPERE)
    s.tick(AMPERE, 5 * AMPERE, NO_SENSOR, 0)
    tripped(s, WIRE_TEMPERATURE, "a thermometer that reads no more")
    s.tick(AMPERE, 5 * AMPERE, -5000, 0)
    holds(s, "one that reads again")
    s.tick(1_050_001, 5 * AMPERE, 9001, 0)
    tripped(s, OVER_CURRENT, "over-current comes first")
    s.command("off", ORDER=SWITCH_OFF, state=OFF)
    old = tuple(int(word, 16) for word in WIRE_WORDS.split())
    s.ask("a host of map version 4 writes its settings", Exchange(0x200, 15, 0x200, old))
    s.ask("the limit stays, and the check word says so", Exchange(0x20F, 1), wire_temperature_max=9000)
    s.settings("a limit below zero", **(limited | {"wire_temperature_max": -1000}))
    s.command("arm", ORDER=ARM, state=ARMED)
    s.tick(0, 0, -1000, 0)
    s.command("just it", state=ARMED)
    s.tick(0, 0, -999, 0)
    s.ask("beyond it", Exchange(0, 0x14), state=TRIPPED, trip=WIRE_TEMPERATURE)
    return s


def crc(words: str) -> int:
    """The check word of settings."""
    return crc16(bytes.fromhex(words))


def slew() -> Script:
    s = armed("amplifier_slew", "rtu", "Slew of 5 A/s: 0.5 A per tick of 0.1 s.", slew_max=5000)
    s.command("0.5 A", CURRENT=500_000, state=ARMED, output=500_000)
    s.command("0.5 A more", CURRENT=AMPERE, state=ARMED, output=AMPERE)
    s.command(
        "1 µA more than that, downwards: accepted, and tripped",
        CURRENT=499_999,
        state=TRIPPED,
        trip=SLEW,
        output=0,
    )
    s.tick(AMPERE, 0, NO_SENSOR, 2)
    s.ask("the first cause stays", Exchange(0, 0x14), state=TRIPPED, trip=SLEW)
    return s


def heat() -> Script:
    s = armed(
        "amplifier_heat", "lines", "The i²t integral in words of 10⁻⁶ A²s, and its trip.", heat_max=296_810
    )
    s.command("1 A", CURRENT=AMPERE, output=AMPERE)
    good(s)
    s.ask("1 A for 0.1 s", Exchange(0, 0x14), heat=100_000)
    good(s)
    s.ask("a hundredth is forgotten", Exchange(0, 0x14), heat=199_000, state=ARMED)
    s.command("fed", CURRENT=AMPERE)
    s.tick(999_999, 5_000_000, NO_SENSOR, 0)
    s.ask(
        "999 whole mA; 1990 forgotten; just heat_max", Exchange(0, 0x14), heat=197_010 + 99_800, state=ARMED
    )
    good(s)
    s.ask(
        "296810 − 2968 + 100000 is too much",
        Exchange(0, 0x14),
        heat=393_842,
        state=TRIPPED,
        trip=HEAT,
        output=0,
    )
    s.tick(-2000, 0, NO_SENSOR, 0)
    s.ask("heat goes on when tripped: 0.4 rounds down", Exchange(0, 0x14), heat=393_842 - 3938)
    slow = WIRE | {"period": 1000, "lease": 2000, "heat_settle": 100, "heat_max": 2**32 - 1}
    s.settings("a tick longer than heat_settle forgets all", **slow)
    s.tick(-1_001_999, 0, NO_SENSOR, 0)
    s.ask("1001² mA² · 1 s", Exchange(0, 0x14), heat=1_002_001)
    s.tick(-2_147_483_648, -2_147_483_648, NO_SENSOR, 0)
    s.ask("no more than the register holds", Exchange(0, 0x14), heat=2**32 - 1)
    s.command("heat that is not above heat_max does not trip", ORDER=REARM, state=ARMED)
    s.tick(0, 0, NO_SENSOR, 0)
    s.ask("nothing is left of it", Exchange(0, 0x14), heat=0, state=ARMED)
    return s
