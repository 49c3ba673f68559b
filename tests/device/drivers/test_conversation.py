"""An exchange with a device: fresh replies, executed once, repeated a few times, and errors that blame the
right device."""

import pytest

from device.drivers.scripted import Scripted
from smarig.core.errors import ConfigError
from smarig.device.drivers._conversation import ATTEMPTS, PAUSES_S, STALE_REPLIES, Conversation
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.link_faults import (
    Garbled,
    Rebooted,
    Refused,
    Silent,
    Stale,
    WrongDevice,
    WrongMap,
)
from smarig.device.encoding.register import load_register_map

MAP = load_register_map("amplifier")


@pytest.fixture
def link():
    return Scripted(MAP)


@pytest.fixture
def talk(link):
    talk = Conversation(link, MAP)
    talk.handshake()
    link.asked.clear()
    return talk


def test_every_command_has_a_sequence_word_new_to_the_device(talk, link):
    for _ in range(3):
        talk.command({"current": 5})
    assert [d["sequence"] for d in link.done] == [42, 43, 44]


@pytest.mark.parametrize("last", [0xFFFF, 2**31 - 1, 2**32 - 2])
def test_the_sequence_does_not_go_round(link, last):
    link.status["echo"] = last
    talk = Conversation(link, MAP)
    talk.handshake()
    assert talk.command({}).values["echo"] == last + 1


def test_after_the_last_sequence_the_device_must_be_restarted(link):
    link.status["echo"] = 2**32 - 1
    talk = Conversation(link, MAP)
    talk.handshake()
    with pytest.raises(Refused, match="has executed 4,294,967,295 commands .* Switch its supply off and on"):
        talk.command({})
    assert not link.done
    link.status |= {"echo": 0, "boot_count": 4}
    talk.handshake()
    assert talk.command({}).values["echo"] == 1


def test_ticks_go_on_where_those_of_the_device_wrap(link):
    link.status["tick"] = 2**32 - 3
    talk = Conversation(link, MAP)
    talk.handshake()
    for after, (tick, first) in enumerate([(2**32 - 2, 2**32 - 2), (3, 2**32 - 1), (5, 4), (5, 6)]):
        link.status |= {"tick": tick, "ring_first": first}
        values = talk.command({"ring_next": 2**32 + 1}).values
        assert link.done[after]["ring_next"] == 1
        assert (values["tick"] % 2**32, values["ring_first"] % 2**32) == (tick, first)
        assert abs(values["tick"] - 2**32) <= 5
        assert abs(values["ring_first"] - 2**32) <= 6
    talk.handshake()
    assert talk.command({}).values["tick"] == 2**32 + 5
    link.status["boot_count"] = 4
    talk.handshake()
    assert talk.command({}).values["tick"] == 5


@pytest.mark.parametrize("trouble", [Silent("-"), Garbled("-")])
def test_a_lost_reply_is_requested_again_with_the_same_sequence_and_executed_once(talk, link, trouble):
    link.next_replies = [trouble, trouble]
    status = talk.command({"current": 700_000})
    assert status.retried
    assert len({e.words for e in link.asked}) == 1
    assert len(link.asked) == 3
    assert [d["current"] for d in link.done] == [700_000]
    assert not talk.command({}).retried


def test_a_stale_reply_is_thrown_away_and_the_right_one_waited_for(talk, link):
    old = reply_before(link)
    link.next_replies, link.late = [old], [old, None]
    link.asked.clear()
    assert talk.command({}).values["echo"] == 42
    assert len(link.asked) == 1


def reply_before(link):
    """The head of the status as it was when the device had executed 41."""
    return link.exchange(Exchange(0, MAP["ring"].address))


def test_only_stale_replies_are_reported_as_stale(talk, link):
    old = reply_before(link)
    link.next_replies = [*[old] * ATTEMPTS, None, *[old] * ATTEMPTS]
    link.late = [old] * 2 * ATTEMPTS * STALE_REPLIES
    with pytest.raises(Stale, match="second program"):
        talk.command({})


def test_a_silent_line_is_reopened_once_and_the_handshake_repeated(talk, link):
    link.next_replies = [Silent("-")] * ATTEMPTS
    assert talk.command({}).retried
    assert link.reopened == talk.reconnections == 1
    assert not link.asked[ATTEMPTS].words, "the handshake after it"


def test_silence_ends_after_so_many_attempts(talk, link):
    link.gone = True
    with pytest.raises(Silent, match="The amplifier cannot be reached"):
        talk.command({})
    assert len(link.asked) == 2 * ATTEMPTS


def test_a_refusal_is_reported_with_its_reason_and_not_retried(talk, link):
    link.next_replies = [Refusal(3)]
    with pytest.raises(Refused, match="out of its range") as refused:
        talk.command({"current": 9})
    assert refused.value.code == 3
    assert len(link.asked) == 1


@pytest.mark.parametrize("code", [8, 9, 6, 99])
def test_a_no_to_what_was_not_understood_is_no_answer(talk, link, code):
    """The request was garbled on the line: nothing has been executed, and it is sent again."""
    link.next_replies = [Refusal(code)]
    assert talk.command({"current": 9}).retried
    assert [d["current"] for d in link.done] == [9]


def test_another_device_and_another_map_are_refused_with_the_remedy(link):
    for change, error, words in (
        ({"kind": 0x5344}, WrongDevice, "exchanged in the rig file"),
        ({"map_hash": 7}, WrongMap, "Update its firmware"),
        ({"map_hash": 7, "version": MAP.device.version + 1}, WrongMap, "Update smarig"),
    ):
        with pytest.raises(error, match=words):
            Conversation(Scripted(MAP, **change), MAP).handshake()


def test_another_register_map_behind_a_reopened_line_is_found(talk, link):
    link.next_replies = [Silent("-")] * ATTEMPTS
    link.status["map_hash"] = 7
    with pytest.raises(WrongMap):
        talk.command({})


def test_a_device_restart_is_reported_once(talk, link):
    link.status |= {"boot_count": 4, "echo": 0}
    with pytest.raises(Rebooted, match="boot 4"):
        talk.command({})
    assert not link.done, "it was made for the boot before"
    talk.command({})
    assert [(d["epoch"], d["sequence"]) for d in link.done] == [(4, 1)]


def test_settings_that_are_not_kept_are_noticed(talk, link):
    talk.settings({"lease": 900})
    assert MAP.decode("settings", link.settings)["lease"] == 900
    link.next_replies = [[0] * MAP.size("settings")]
    with pytest.raises(Garbled, match="read back from the .* differ"):
        talk.settings({"lease": 900})


def test_a_missing_port_is_retried_for_a_limited_time(talk, link, monkeypatch):
    waited: list[float] = []
    monkeypatch.setattr("smarig.device.drivers._conversation.time.sleep", waited.append)
    link.gone = True
    link.reopen = lambda: (_ for _ in ()).throw(Silent("no such port"))
    with pytest.raises(Silent, match="cannot be reached. no such port"):
        talk.command({})
    assert waited == list(PAUSES_S)
    assert sum(waited) < 0.5, "the least lease"


def test_a_setting_that_no_device_keeps_is_refused_by_name_before_it_is_sent(talk, link):
    with pytest.raises(ConfigError, match=r"lease = 10 s is outside 0.5…2 s"):
        talk.settings({"lease": 10_000})
    assert not link.asked
