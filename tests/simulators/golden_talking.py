"""Golden scripts of communication: handshake, valid and invalid frames and lines, a session, repetitions."""

from golden import Script
from golden_words import (
    AMPERE,
    ARM,
    ARMED,
    NO_SENSOR,
    OFF,
    REARM,
    SAFE_CRC,
    SWITCH_OFF,
    WIRE,
    armed,
    frame,
    good,
    line,
)

from smarig.device.encoding.exchange import Exchange
from smarig.device.encoding.register import to_words


def handshake() -> Script:
    s = Script("amplifier_handshake", "amplifier", "rtu", "Who are you, and what do you begin with?")
    who = {"kind": 0x5341, "version": 5, "map_hash": s.map_hash, "boot_count": 7}
    s.ask("kind … boot_count", Exchange(1, 6), **who)
    s.ask(
        "the head of the status block", Exchange(0, 0x14), echo=0, tick=0, state=OFF, output=0, lease_left=0
    )
    s.ask("all of it, ring and all", Exchange(0, 121), ring_first=0, ring_count=0)
    s.ask(
        "what boot and build decide",
        Exchange(0x14, 5),
        settings_crc=SAFE_CRC,
        arm_nonce=7 << 16,
        board_max=2 * AMPERE,
    )
    s.ask(
        "the command block is safe",
        Exchange(0x100, 12),
        sequence=0,
        epoch=7,
        order=0,
        current=0,
        ring_want=0,
        nonce=0,
    )
    safe = {"period": 100, "lease": 500, "current_min": 0, "current_max": 0, "slew_max": 1000, "heat_max": 1}
    s.ask(
        "the settings are safe",
        Exchange(0x200, 16),
        resistance_max=1_000_000,
        heat_settle=1000,
        wire_temperature_max=NO_SENSOR,
        **safe,
    )
    s.ask("one word", Exchange(1, 1), kind=0x5341)
    s.ask("one field of a record", Exchange(0x19, 2))
    s.ask("part of a 32-bit value", Exchange(3, 1), refused=2)
    s.ask("from within a 32-bit value", Exchange(4, 1), refused=2)
    s.ask("part of the nonce", Exchange(0, 0x16), refused=2)
    s.ask("part of a field", Exchange(0, 0x1A), refused=2)
    s.ask("beyond the status block", Exchange(0, 122), refused=2)
    s.ask("between blocks", Exchange(0x80, 1), refused=2)
    s.ask("over the end of the addresses", Exchange(0xFFFF, 2), refused=2)
    return s


def frames() -> Script:
    s = Script("amplifier_frames", "amplifier", "rtu", "Frames good and bad; hexadecimal.")
    good_reply = frame("41 03 02 53 41")
    s.raw("function 3, one word", frame("41 03 0001 0001"), good_reply)
    s.raw("wrong check word", "41030001000195d8", None)
    s.raw("another address", frame("42 03 0001 0001"), None)
    s.raw("broadcast", frame("00 03 0001 0001"), None)
    s.raw("too short for a frame", "4103", None)
    s.raw("nothing", "", None)
    s.raw("function 6 is not spoken", frame("41 06 0100 0001"), frame("41 86 01"))
    s.raw("no word asked for", frame("41 03 0001 0000"), frame("41 83 03"))
    s.raw("126 words asked for", frame("41 03 0000 007E"), frame("41 83 03"))
    s.raw("125 fit a frame, but so many registers are not there", frame("41 03 0000 007D"), frame("41 83 02"))
    s.raw("function 3, one byte too many", frame("41 03 0001 0001 00"), frame("41 83 03"))
    s.raw("function 3, too short", frame("41 03 0001"), frame("41 83 03"))
    one = "41 10 0100 0004 08 00000001 00000007"
    s.raw("function 16: sequence 1 of boot 7", frame(one), frame("41 10 0100 0004"))
    s.raw("bytes do not fit words", frame("41 10 0100 0002 05 00000001"), frame("41 90 03"))
    s.raw("no words", frame("41 10 0100 0000 00"), frame("41 90 03"))
    s.raw("122 words", frame("41 10 0100 007A F4" + " 0001" * 122), frame("41 90 03"))
    both = "41 17 0007 0002 0100 0004 08 00000002 00000007"
    s.raw("function 23: sequence 2, echo read after the write", frame(both), frame("41 17 04 00000002"))
    three = "0100 0004 08 00000003 00000007"
    s.raw("function 23, nothing to read", frame(f"41 17 0000 0000 {three}"), frame("41 97 03"))
    s.raw("a read that cannot be undoes the write", frame(f"41 17 0080 0001 {three}"), frame("41 97 02"))
    s.raw("echo is still 2", frame("41 03 0007 0002"), frame("41 03 04 00000002"))
    return s


def text() -> Script:
    s = Script("amplifier_text", "amplifier", "lines", "What a person may type, and what not.")
    kind = line("= 5341")
    s.raw("no check word where nothing is written", "r 1 1", kind)
    s.raw("four digits", "r 0001 0001", kind)
    s.raw("a carriage return is ignored", "r 1 1\r", kind)
    s.raw("with check word", line("r 0001 0001"), kind)
    s.raw("either case", line("r 000C 0002").lower().replace("000c", "000C"), line("= 0000 0000"))
    s.raw("an empty line", "", None)
    s.raw("an empty line with a carriage return", "\r", None)
    s.raw("a write with check word", line("w 0100 0000 0001 0000 0007"), line("="))
    s.raw("a write without", "w 0100 0000 0002 0000 0007", line("! 8"))
    s.raw("a wrong check word", "r 1 1 *0000", line("! 8"))
    s.raw("a check word of three digits is none", "r 1 1 *000", line("! 9"))
    s.raw("write and read", line("w 100 0 2 0 7 r 7 2"), line("= 0000 0002"))
    s.raw("lower-case digits", line("w 0200 0064 01f4"), line("="))
    for bad in (
        "x",
        " ",
        "r",
        "r 1",
        "r 1 1 1",
        "r  1 1",
        " r 1 1",
        "r 00001 1",
        "r g 1",
        "R 1 1",
        "r 1 1 w 100 0 1",
    ):
        s.raw("cannot be read", bad, line("! 9"))
    for bad in ("w 0100", "w 0100 0 3 ", "w 0100 0 3r 0 1", "w 0100 0 3  r 0 1", "w 0100 0 00003"):
        s.raw("cannot be read, though the check word is right", line(bad), line("! 9"))
    s.raw("nothing but a check word", "*FFFF", line("! 9"))
    s.raw("too long", "r" * 1001, line("! 9"))
    s.raw("no words", "r 0 0", line("! 3"))
    s.raw("more words than an exchange has", "r 0 7E", line("! 3"))
    s.raw("no such register", "r 80 1", line("! 2"))
    s.raw("echo is 2: nothing bad was done", "r 7 2", line("= 0000 0002"))
    return s


def settings() -> Script:
    s = Script("amplifier_settings", "amplifier", "lines", "Settings, whole and in part.")
    s.settings("settings", **WIRE)
    s.ask("settings are as written", Exchange(0x200, 15), **WIRE)
    s.settings("a lease under its range", 3, **(WIRE | {"lease": 499}))
    s.settings("a limit of the wrong sign", 3, **(WIRE | {"current_min": 1}))
    s.ask("settings are as before", Exchange(0x200, 15), **WIRE)
    s.ask("the first two settings alone", Exchange(write_at=0x200, words=(100, 1000)))
    s.ask("half of a limit", Exchange(write_at=0x200, words=(100, 500, 0)), refused=2)
    s.ask("not from the block's first register on", Exchange(write_at=0x201, words=(500,)), refused=2)
    s.ask("a register that is only read", Exchange(write_at=0x000, words=(1,)), refused=2)
    s.ask("more than the block", Exchange(write_at=0x200, words=(100,) * 17), refused=2)
    s.ask("only the lease is another", Exchange(0x200, 15), **(WIRE | {"lease": 1000}))
    return s


def work() -> Script:
    s = Script("amplifier_work", "amplifier", "lines", "Arm, currents, off; what is refused on the way.")
    s.command("a current before arming", CURRENT=1, refused=4)
    s.ask("nothing was heard: no echo", Exchange(7, 2), echo=0)
    s.settings("settings, with a lease of 1 s", **(WIRE | {"lease": 1000}))
    s.command("sequence 0", SEQUENCE=0, refused=3)
    s.command("an order that is none", ORDER=4, refused=3)
    s.command("more samples than a reply holds", RING_WANT=13, refused=3)
    s.command("rearm is also allowed from off", ORDER=REARM, state=ARMED, trip=0, output=0, lease_left=1000)
    s.command("arm while armed", ORDER=ARM, refused=4)
    s.command("rearm while armed", ORDER=REARM, refused=4)
    s.settings("settings while armed", 4, **WIRE)
    s.command("half an ampere", CURRENT=500_000, output=500_000)
    s.command("more than current_max", CURRENT=1_000_001, refused=3)
    s.command("less than current_min", CURRENT=-1, refused=3)
    s.command("more than its range", CURRENT=5_000_001, refused=3)
    s.ask("the output is as before", Exchange(0, 0x14), output=500_000, state=ARMED)
    s.ask(
        "sequence, epoch and order alone keep the current",
        Exchange(0, 0x14, 0x100, (*s.proof(word := s.next_word()), 0)),
        output=500_000,
        echo=word,
    )
    s.ask("half of a current", Exchange(7, 2, 0x100, (*s.proof(1000), 0, 1)), refused=2)
    s.command(
        "off; the current beside it does not matter", ORDER=SWITCH_OFF, CURRENT=AMPERE, state=OFF, output=0
    )
    s.ask("order and nonce read 0, current as written", Exchange(0x100, 12), order=0, current=AMPERE, nonce=0)
    s.command("a current after off", CURRENT=1, refused=4)
    s.command("a current beside off, when off", ORDER=SWITCH_OFF, CURRENT=1, refused=4)
    s.command("arm and a current at once", ORDER=ARM, CURRENT=250_000, state=ARMED, output=250_000)
    s.command("no current is always allowed", CURRENT=0, output=0, state=ARMED)
    return s


def repeats() -> Script:
    s = armed("amplifier_repeats", "rtu", "The same sequence again: answered, not done again.")
    s.command("0.4 A", CURRENT=400_000, output=400_000)
    again = {"again": True, "output": 400_000, "state": ARMED}
    s.command("the same again", CURRENT=400_000, **again)
    s.command("another current with the same sequence is not taken", CURRENT=900_000, **again)
    s.command("nor is an order", ORDER=SWITCH_OFF, **again)
    s.command("what would be refused now is not, since it is not done", ORDER=ARM, **again)
    s.command("a word out of its range is refused all the same", ORDER=9, again=True, refused=3)
    s.ask("current reads as it was accepted", Exchange(0x100, 10), current=400_000, order=0)
    good(s, 400_000, times=3)
    s.command(
        "the window follows the repeated exchange",
        RING_NEXT=2,
        RING_WANT=1,
        ring_first=2,
        ring_count=1,
        **again,
    )
    s.ask("and is what is read later", Exchange(0, 0x14), ring_first=2, ring_count=1, tick=3)
    good(s, 400_000, times=2)
    s.command("a repeated sequence does not feed the lease", lease_left=0, **again)
    s.command("a new one does", CURRENT=400_000, output=400_000, state=ARMED, lease_left=500)
    s.command("off", ORDER=SWITCH_OFF, output=0, state=OFF)
    s.ask("an old arm frame is answered and does nothing", numbered(s, 1, ARM, 7 << 16), state=OFF, output=0)
    s.ask("nor does a sequence too far ahead", numbered(s, s.word + 257, ARM, s.nonce), state=OFF, output=0)
    s.ask(
        "the last of the next 256 is new",
        numbered(s, s.word + 256, ARM, s.nonce),
        state=ARMED,
        echo=s.word + 256,
    )
    s.ask("after it, the one before it is old", numbered(s, s.word + 255, SWITCH_OFF), state=ARMED)
    return s


def numbered(s: Script, word: int, order: int, nonce: int = 0) -> Exchange:
    """A command with a sequence of its own."""
    return Exchange(0, 0x14, 0x100, (*s.proof(word), order, 0, 0, 0, 0, 0, *to_words(nonce, 2)))
