"""Golden scripts of samples: rings, windows, the encoder DAQ."""

from golden import Script
from golden_words import NO_SENSOR, frame

from smarig.device.encoding.exchange import Exchange
from smarig.device.encoding.register import to_words


def ring() -> Script:
    s = Script("amplifier_ring", "amplifier", "rtu", "Windows of the ring: 256 samples, 12 in one reply.")
    s.command("nothing is there yet", RING_NEXT=0, RING_WANT=12, ring_first=0, ring_count=0)
    s.command("nor from tick 1 on", RING_NEXT=1, RING_WANT=12, ring_first=1, ring_count=0)
    for k in range(1, 4):
        s.tick(k, -k, 2000 + k, k & 1)
    s.ask("a window stays as it was chosen", Exchange(0, 0x14), tick=3, ring_first=1, ring_count=0)
    s.command("all that is there", RING_NEXT=1, RING_WANT=12, read=121, ring_first=1, ring_count=3)
    s.command("as old as there is", RING_NEXT=0, RING_WANT=2, read=121, ring_first=1, ring_count=2)
    s.command("the newest", RING_NEXT=3, RING_WANT=12, read=0x21, ring_first=3, ring_count=1)
    s.command("none wanted", RING_NEXT=2, RING_WANT=0, ring_first=2, ring_count=0)
    s.command("the future", RING_NEXT=4, RING_WANT=12, ring_first=4, ring_count=0)
    half = 2**31
    s.command("the far future", RING_NEXT=3 + half, RING_WANT=12, ring_first=3 + half, ring_count=0)
    s.command("what is yet further is the past", RING_NEXT=4 + half, RING_WANT=12, ring_first=1, ring_count=3)
    s.command("the two words before the window keep it", RING_NEXT=2, RING_WANT=1, ring_first=2, ring_count=1)
    s.ask(
        "sequence and epoch alone: chosen anew, by what was asked last",
        Exchange(0, 0x14, 0x100, s.proof(s.next_word())),
        ring_first=2,
    )
    for k in range(4, 258):
        s.tick(k, -k, NO_SENSOR, 0)
    s.ask(
        "a window keeps samples that the ring has lost",
        Exchange(0, 0x21),
        tick=257,
        ring_first=2,
        ring_count=1,
    )
    s.command("tick 1 is lost", RING_NEXT=1, RING_WANT=1, read=0x21, ring_first=2, ring_count=1)
    s.command("tick 2 is the oldest", RING_NEXT=2, RING_WANT=12, read=121, ring_first=2, ring_count=12)
    s.command("up to the newest", RING_NEXT=250, RING_WANT=12, read=121, ring_first=250, ring_count=8)
    return s


def daq_work() -> Script:
    s = Script("daq_work", "encoder_daq", "lines", "Handshake, zero, index, supply, settings.")
    who = {"kind": 0x5344, "version": 3, "map_hash": s.map_hash, "boot_count": 7}
    s.ask("kind … boot_count", Exchange(1, 6), **who)
    s.ask("all of the status block", Exchange(0, 113), tick=0, fault=0, counts=0, index_count=0, ring_count=0)
    s.ask("safe", Exchange(0x200, 1), period=100)
    s.now(-123_456)
    s.ask("the place now", Exchange(0, 0x11), counts=-123_456, tick=0)
    s.tick(1000, 2215, 0)
    s.now(1010)
    s.ask("a sample, and the place now", Exchange(0, 0x11), counts=1010, tick=1)
    s.command(
        "zero here", ORDER=1, RING_NEXT=1, RING_WANT=24, counts=0, ring_first=1, ring_count=1, read=0x15
    )
    s.command("the same sequence does not zero again", again=True, ORDER=1, counts=0)
    s.now(1012)
    s.command("nor elsewhere", again=True, ORDER=1, counts=2)
    zero = (*to_words(s.word + 1, 2), *to_words(8, 2), 1)
    s.ask("nor does a zero of another boot", Exchange(0, 0x11, 0x100, zero), counts=2, echo=1)
    s.ask("order reads 0", Exchange(0x100, 8), order=0, sequence=1, epoch=7)
    s.tick(1013, 2215, 1)
    s.tick(1014, -32_768, 2)
    s.tick(1015, 2216, 7)
    marks = {"index_count": 2, "fault": 1, "counts": 5}
    s.command("marks: index, illegal step, both", RING_NEXT=1, RING_WANT=24, read=0x21, ring_count=4, **marks)
    s.tick(1015, 2216, 0)
    s.ask("the fault is gone", Exchange(0, 0x11), fault=0, counts=5)
    s.tick(-2_147_483_648, 2216, 0)
    s.ask("counts go round", Exchange(0, 0x11), counts=2**31 - 1010)
    s.command("an order that is none", ORDER=2, refused=3)
    s.command("too many samples", RING_WANT=25, refused=3)
    s.ask("echo is as before", Exchange(7, 2), echo=2)
    s.ask("a period", Exchange(0x200, 1, 0x200, (50,)), period=50)
    s.ask("no period", Exchange(0x200, 1, 0x200, (0,)), refused=3)
    s.ask("more than the block", Exchange(write_at=0x200, words=(50, 50)), refused=2)
    s.ask("half of ring_next", Exchange(write_at=0x100, words=(*s.proof(9), 0, 0)), refused=2)
    s.ask("only read", Exchange(write_at=0x00B, words=(0, 0)), refused=2)
    s.ask("part of counts", Exchange(0, 12), refused=2)
    return s


def daq_ring() -> Script:
    s = Script("daq_ring", "encoder_daq", "rtu", "Windows of the ring: 1024 samples, 24 in one reply.")
    for k in range(1, 1026):
        s.tick(10 * k, k, 0)
    s.command(
        "tick 1 is lost", RING_NEXT=1, RING_WANT=24, read=113, ring_first=2, ring_count=24, counts=10_250
    )
    s.command("as old as there is", RING_NEXT=0, RING_WANT=1, read=0x15, ring_first=2, ring_count=1)
    s.command("up to the newest", RING_NEXT=1020, RING_WANT=24, read=113, ring_first=1020, ring_count=6)
    s.command("the future", RING_NEXT=1026, RING_WANT=24, ring_first=1026, ring_count=0, tick=1025)
    s.raw("wrong check word", "6403000000110000", None)
    s.raw("not for us", frame("41 03 0000 0011"), None)
    return s
