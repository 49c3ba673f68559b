"""A reply that differs from the order: the amplifier is switched off, says why, and its readings are suspect."""

import pytest

from device.drivers.scripted import Scripted
from smarig.core.errors import ConfigError
from smarig.core.sample import Quality
from smarig.device.drivers.smarig_amplifier import SmarigAmplifier
from smarig.device.encoding.exchange import Refusal
from smarig.device.encoding.link_faults import Refused
from smarig.device.encoding.register import load_register_map

SETTINGS = {"period": 0.1, "lease": 1.0, "current_min": 0.0, "current_max": 1.0, "resistance_max": 20.0}
NONE, ARM, OFF = 0, 1, 2
WINDOW = {"tick": 9, "ring_first": 5, "ring_count": 2}
OTHER_OUTPUT = ({"output": 479_000}, "it drives 0.479 A, but 0.25 A is ordered")
NO_OUTPUT = ({"output": 0}, "it drives 0 A, but 0.25 A is ordered")
OTHER_STATE = ({"state": 0}, "it is not armed, against its order")
OTHER_SETTINGS = ({"settings_crc": 0x1234}, "its settings are not those that were written")
DIFFERENCES = pytest.mark.parametrize(
    ("says", "reason"), [OTHER_OUTPUT, NO_OUTPUT, OTHER_STATE, OTHER_SETTINGS]
)


@pytest.fixture
def link():
    return Scripted(load_register_map("amplifier"))


@pytest.fixture
def amplifier(link):
    amplifier = SmarigAmplifier(link, SETTINGS)
    link.done.clear()
    return amplifier


def orders(link):
    return [d["order"] for d in link.done]


@DIFFERENCES
def test_a_set_whose_reply_differs_switches_off(link, amplifier, says, reason):
    amplifier.set(0.5)
    assert amplifier.tripped == ""
    link.status |= says
    amplifier.set(0.25)
    assert OFF in orders(link)
    assert orders(link)[0] == ARM
    assert "contradicts its order" in amplifier.tripped
    assert reason in amplifier.tripped
    assert link.status["echo"] == link.done[-1]["sequence"], "the off was accepted"


@DIFFERENCES
def test_a_reading_whose_reply_differs_is_suspect(link, amplifier, says, reason):
    amplifier.set(0.25)
    link.status |= WINDOW
    assert [r.quality for r in amplifier.since(5, 2)] == [Quality.GOOD] * 2
    link.status |= says
    assert [r.quality for r in amplifier.since(5, 2)] == [Quality.SUSPECT] * 2
    assert OFF in orders(link)
    assert reason in amplifier.tripped


def test_the_clock_is_read_from_a_reply_that_is_compared(link, amplifier):
    amplifier.set(0.25)
    link.status["output"] = 1
    amplifier.tick()
    assert "it drives 1e-06 A" in amplifier.tripped
    assert orders(link)[-1] == OFF


def test_after_a_contradiction_no_current_is_sent_and_all_readings_are_suspect(link, amplifier):
    amplifier.set(0.25)
    link.status["output"] = 300_000
    amplifier.tick()
    del link.status["output"]
    link.status |= WINDOW
    link.done.clear()
    amplifier.set(0.5)
    assert [r.quality for r in amplifier.since(5, 2)] == [Quality.SUSPECT] * 2
    assert not any(d["current"] for d in link.done)
    assert not any(orders(link))
    assert "contradicts" in amplifier.tripped


def test_arming_anew_ends_a_contradiction(link, amplifier):
    amplifier.set(0.25)
    link.status["output"] = 300_000
    amplifier.tick()
    del link.status["output"]
    amplifier.arm()
    assert amplifier.tripped == ""
    amplifier.set(0.25)
    link.status |= WINDOW
    assert [r.quality for r in amplifier.since(5, 2)] == [Quality.GOOD] * 2
    assert amplifier.tripped == ""


def test_a_trip_is_no_contradiction(link, amplifier):
    amplifier.set(0.25)
    link.status |= {"state": 2, "trip": 1, "output": 0}
    amplifier.since(1, 1)
    assert "lease" in amplifier.tripped
    assert "contradicts" not in amplifier.tripped
    assert OFF not in orders(link)


def test_a_current_that_another_host_made_impossible_is_a_contradiction(link, amplifier):
    """Refused, because it is off by another's order."""
    amplifier.set(0.25)
    link.status |= {"state": 0, "output": 0}
    link.next_replies = [Refusal(4)]
    amplifier.set(0.5)
    assert "against its order" in amplifier.tripped or "it drives 0 A" in amplifier.tripped


def test_a_refused_current_of_an_armed_amplifier_is_refused(link, amplifier):
    amplifier.set(0.25)
    link.next_replies = [Refusal(3)]
    with pytest.raises(Refused):
        amplifier.set(0.5)


def test_arming_carries_the_nonce_of_the_last_reply_and_nothing_else_does(link, amplifier):
    nonce = 3 << 16 | 1  # one command was executed before
    amplifier.set(0.25)
    amplifier.set(0.5)
    amplifier.off()
    assert [(d["order"], d["nonce"]) for d in link.done] == [
        (ARM, nonce),
        (NONE, 0),
        (NONE, 0),
        (OFF, 0),
    ]


def test_a_rig_file_that_asks_for_more_than_the_board_bears_is_refused_by_name(link):
    link.status["board_max"] = 500_000
    with pytest.raises(ConfigError, match=r"built for at most 0.5 A; the rig file allows 1 A. Lower limits"):
        SmarigAmplifier(link, SETTINGS)
    assert not any(e.words for e in link.asked), "nothing was written"
    with pytest.raises(ConfigError, match="the rig file allows 0.75 A"):
        SmarigAmplifier(link, SETTINGS | {"current_min": -0.75, "current_max": 0.5})
    SmarigAmplifier(link, SETTINGS | {"current_min": -0.5, "current_max": 0.5})
