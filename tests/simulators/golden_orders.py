"""Golden scripts of trust between host and amplifier: the nonce of arming, the output of each tick, the settings."""

from golden import Script
from golden_words import (
    AMPERE,
    ARM,
    ARMED,
    NO_SENSOR,
    OFF,
    REARM,
    SAFE_CRC,
    STOP,
    SWITCH_OFF,
    TRIPPED,
    WIRE,
    armed,
)

from smarig.device.encoding.crc import crc16
from smarig.device.encoding.exchange import Exchange
from smarig.device.encoding.register import to_words

BOOT = 7 << 16  # of the scripts, as the upper word of the nonce
WIRE_CRC = crc16(bytes.fromhex("0064 01F4 0000 0000 000F 4240 0000 61A8 0000 03E8 0000 4E20 001E 8480 2710"))
LONGER_LEASE_CRC = crc16(
    bytes.fromhex("0064 03E8 0000 0000 000F 4240 0000 61A8 0000 03E8 0000 4E20 001E 8480 2710")
)


def nonce() -> Script:
    s = Script(
        "amplifier_nonce",
        "amplifier",
        "rtu",
        "Arming needs the nonce; each order is followed by another one.",
    )
    s.settings("settings", **WIRE)
    s.ask("the nonce after boot 7", Exchange(0x15, 2), arm_nonce=BOOT)
    for why, wrong in (
        ("none", 0),
        ("the next one", BOOT + 1),
        ("the one before", BOOT - 1),
        ("of another boot", 8 << 16),
        ("its words exchanged", 7),
    ):
        s.command(f"arm, {why}", ORDER=ARM, NONCE=wrong, refused=4)
        s.command(f"rearm, {why}", ORDER=REARM, NONCE=wrong, refused=4)
    short = Exchange(0, 0x14, 0x100, (*s.proof(s.next_word()), ARM, 0, 0, 0, 0, 0))
    s.ask("arm without the word at all", short, refused=4)
    s.ask("nothing was heard", Exchange(0, 0x17), echo=0, state=OFF, arm_nonce=BOOT)
    s.command("arm", ORDER=ARM, NONCE=BOOT, state=ARMED, arm_nonce=BOOT + 1)
    first = s.word
    s.command("a current is no order", CURRENT=AMPERE, output=AMPERE, arm_nonce=BOOT + 1)
    s.ask("nonce and order read 0", Exchange(0x100, 12), order=0, nonce=0, current=AMPERE)
    s.command("off needs none", ORDER=SWITCH_OFF, NONCE=12_345, state=OFF, arm_nonce=BOOT + 2)
    frame = (ARM, 15, 0x4240, 0, 0, 0, 7, 0)  # of the arming, and an ampere with it
    s.ask("its arm frame again", Exchange(0, 0x14, 0x100, (*s.proof(first), *frame)), state=OFF, output=0)
    s.ask(
        "and with a sequence of now", Exchange(0, 0x14, 0x100, (*s.proof(s.next_word()), *frame)), refused=4
    )
    s.command("off again is an order, too", ORDER=SWITCH_OFF, state=OFF, arm_nonce=BOOT + 3)
    s.command("the nonce of before", ORDER=REARM, NONCE=BOOT + 2, refused=4)
    s.command("rearm", ORDER=REARM, NONCE=BOOT + 3, state=ARMED, arm_nonce=BOOT + 4)
    s.command("rearm while armed", ORDER=REARM, NONCE=BOOT + 4, refused=4)
    s.tick(0, 0, NO_SENSOR, 2)
    s.ask("a trip is no order", Exchange(0, 0x17), state=TRIPPED, trip=STOP, arm_nonce=BOOT + 4)
    s.command("rearm with the nonce that armed before", ORDER=REARM, NONCE=BOOT + 3, refused=4)
    s.command("rearm", ORDER=REARM, NONCE=BOOT + 4, state=ARMED, arm_nonce=BOOT + 5)
    s.command("the same sequence is no order", again=True, ORDER=SWITCH_OFF, state=ARMED, arm_nonce=BOOT + 5)
    return s


def epoch() -> Script:
    s = Script(
        "amplifier_epoch", "amplifier", "rtu", "A command of another boot is answered and does nothing."
    )
    s.settings("settings", **WIRE)
    wrong = (0, 6, 8, 7 + 2**16, 7 + 2**31, 7 << 16)
    for boot in wrong:
        s.command(f"arm in boot {boot}", ORDER=ARM, EPOCH=boot, state=OFF, echo=0, arm_nonce=BOOT)
    s.command("arm in boot 7", ORDER=ARM, EPOCH=7, state=ARMED, echo=s.word + 1, boot_count=7)
    s.command("half an ampere", CURRENT=500_000, output=500_000)
    last = s.word
    for boot in wrong:
        s.command(f"another current in boot {boot}", CURRENT=100_000, EPOCH=boot, output=500_000, echo=last)
    s.tick(500_000, 2_500_000, NO_SENSOR, 0, times=5)
    for boot in wrong:
        s.command(f"lease and current in boot {boot}", EPOCH=boot, CURRENT=500_000, lease_left=0, echo=last)
    s.command("not even off", ORDER=SWITCH_OFF, EPOCH=8, state=ARMED, output=500_000)
    numbers = to_words(s.next_word(), 2)
    s.ask("a sequence without its boot", Exchange(0, 0x14, 0x100, tuple(numbers)), lease_left=0, echo=last)
    s.ask("half of a boot", Exchange(0, 0x14, 0x100, (*numbers, 0)), refused=2)
    s.command(
        "only the window is taken",
        EPOCH=8,
        RING_NEXT=2,
        RING_WANT=3,
        ring_first=2,
        ring_count=3,
        lease_left=0,
    )
    s.command("what is out of its range is refused all the same", EPOCH=8, ORDER=9, refused=3)
    s.command("of boot 7: fed", CURRENT=500_000, output=500_000, lease_left=500)
    s.ask("reads as it was executed", Exchange(0x100, 4), sequence=s.word, epoch=7)
    return s


def outputs() -> Script:
    s = armed(
        "amplifier_outputs", "lines", "What was ordered to flow in each tick, with what was measured in it."
    )
    s.tick(0, 0, NO_SENSOR, 0)
    s.command("0.4 A", CURRENT=400_000, output=400_000)
    s.tick(399_000, 1_995_000, NO_SENSOR, 0)
    s.command("0.6 A", CURRENT=600_000, output=600_000)
    s.tick(601_000, 3_005_000, NO_SENSOR, 2)
    s.tick(5000, 25_000, NO_SENSOR, 0)
    s.command("after the trip", state=TRIPPED, trip=STOP, output=0)
    s.command("rearm, 0.25 A", ORDER=REARM, CURRENT=250_000, output=250_000)
    s.tick(250_000, 1_250_000, 2000, 1)
    s.command("off", ORDER=SWITCH_OFF, output=0, state=OFF)
    s.tick(100, 0, 2000, 0)
    samples = (
        (0, 0, 0, NO_SENSOR, 0),
        (399_000, 1_995_000, 400_000, NO_SENSOR, 0),
        (601_000, 3_005_000, 600_000, NO_SENSOR, 2),  # this tick ended with the trip
        (5000, 25_000, 0, NO_SENSOR, 2),
        (250_000, 1_250_000, 250_000, 2000, 1),
        (100, 0, 0, 2000, 0),
    )
    s.command("six ticks", RING_NEXT=1, RING_WANT=12, read=73, samples=samples, ring_first=1, ring_count=6)
    return s


def board() -> Script:
    s = Script(
        "amplifier_board", "amplifier", "lines", "The CRC of the settings, and settings beyond this board."
    )
    crc = Exchange(0x14, 1)
    s.ask("of the settings at boot", crc, settings_crc=SAFE_CRC)
    s.settings("settings", **WIRE)
    s.ask("of the settings as written", crc, settings_crc=WIRE_CRC)
    s.settings("a lease under its range", 3, **(WIRE | {"lease": 499}))
    s.ask("as before", crc, settings_crc=WIRE_CRC)
    s.ask(
        "the first two settings alone", Exchange(0x14, 1, 0x200, (100, 1000)), settings_crc=LONGER_LEASE_CRC
    )
    s.ask("a period beyond half of the lease that stands", Exchange(write_at=0x200, words=(501,)), refused=3)
    s.ask("of the lease beside it", Exchange(write_at=0x200, words=(500, 999)), refused=3)
    s.ask("as before", crc, settings_crc=LONGER_LEASE_CRC)
    s.ask("just half of it", Exchange(0x200, 2, 0x200, (500,)), period=500, lease=1000)
    s.settings("the longest period there is", **(WIRE | {"period": 1000, "lease": 2000}))
    s.settings("1 ms more", 3, **(WIRE | {"period": 1001, "lease": 2000}))
    s.settings(
        "the board's largest currents", **(WIRE | {"current_max": 2 * AMPERE, "current_min": -2 * AMPERE})
    )
    s.settings("1 µA more", 3, **(WIRE | {"current_max": 2 * AMPERE + 1}))
    s.settings("and less", 3, **(WIRE | {"current_min": -2 * AMPERE - 1}))
    s.ask("as they were", Exchange(0x200, 15), current_max=2 * AMPERE, current_min=-2 * AMPERE, period=100)
    s.settings("settings", **WIRE)
    s.command("arm", ORDER=ARM, state=ARMED)
    s.settings("armed: not now, whatever the board bears", 4, **(WIRE | {"current_max": 2 * AMPERE + 1}))
    s.settings("nor another period", 4, **(WIRE | {"period": 1000}))
    s.settings("a word out of its range is refused as such", 3, **(WIRE | {"current_max": 5 * AMPERE + 1}))
    s.ask("as before", crc, settings_crc=WIRE_CRC)
    return s
