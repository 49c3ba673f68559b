"""Faults of bytes: their influence on requests and replies, always the same for the same seed."""

from simulators import faults
from simulators.line_troubles import Late, LineFaults

DEVICE = {"device": "amplifier"}


def replies(*wrong: faults.SimulatedFault, exchange: int = 1, time_s: float = 0) -> list[Late]:
    return LineFaults(wrong).replies(b"abc", time_s, exchange)


def test_nothing_wrong():
    assert replies() == [Late(0, b"abc")]
    assert LineFaults(()).requests(b"abc", 0, 1) == [b"abc"]


def test_one_bit_of_a_share_of_replies():
    garbled = faults.GarbledBytes(kind="garbled", share=0.25, seed=3, **DEVICE)
    heard = [replies(garbled, exchange=k)[0].data for k in range(1, 1001)]
    wrong = [int.from_bytes(data) ^ int.from_bytes(b"abc") for data in heard if data != b"abc"]
    assert 200 < len(wrong) < 300
    assert all(bits.bit_count() == 1 for bits in wrong)
    assert heard == [replies(garbled, exchange=k)[0].data for k in range(1, 1001)]
    assert LineFaults([garbled]).requests(b"abc", 0, 1) == [b"abc"]
    certain = faults.GarbledBytes(kind="garbled", direction="request", **DEVICE)
    assert LineFaults([certain]).requests(b"", 0, 1) == [b""]


def test_dropped_repeated_delayed_and_noisy():
    assert replies(faults.Dropped(kind="dropped", **DEVICE)) == []
    assert replies(faults.Repeated(kind="repeated", **DEVICE)) == [Late(0, b"abc")] * 2
    assert replies(faults.Delayed(kind="delayed", delay_s=0.3, **DEVICE)) == [Late(0.3, b"abc")]
    ((_, noisy),) = replies(faults.ForeignBytes(kind="foreign_bytes", bytes=4, seed=1, **DEVICE))
    assert (len(noisy), noisy[4:]) == (7, b"abc")


def test_requests_have_a_direction_of_their_own():
    dropped = faults.Dropped(kind="dropped", direction="request", **DEVICE)
    assert LineFaults([dropped]).requests(b"abc", 0, 1) == []
    assert replies(dropped) == [Late(0, b"abc")]


def test_a_dead_line_and_an_unplugged_port_have_their_time():
    dead = LineFaults([faults.DeadLine(kind="dead_line", from_s=1, to_s=2, **DEVICE)])
    assert [len(dead.requests(b"abc", t, 1)) for t in (0.9, 1.0, 2.0)] == [1, 0, 1]
    assert [len(dead.replies(b"abc", t, 1)) for t in (0.9, 1.0, 2.0)] == [1, 0, 1]
    unplugged = LineFaults([faults.Unplugged(kind="unplugged", from_s=1, to_s=2, **DEVICE)])
    assert [unplugged.plugged(t, 1) for t in (0.9, 1.0, 2.0)] == [True, False, True]
