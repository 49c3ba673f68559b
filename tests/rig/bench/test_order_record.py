"""The currents that were ordered, tick by tick, against what the source says it drove."""

import pytest

from smarig.core.sample import NAN, Quality
from smarig.device.roles.ticked import CurrentReading
from smarig.rig.order_record import KEPT, OrderRecord


def driven(tick, output_A, quality=Quality.GOOD):
    return CurrentReading(tick, 0.0, 0.0, NAN, quality, output_A)


@pytest.fixture
def record():
    """0 A, then 0.5 A after tick 10, read up to tick 10."""
    record = OrderRecord()
    record.read_until(10)
    record.changed(0.0, 10)
    return record


def test_a_current_counts_from_the_tick_after_its_reply(record):
    assert record.at(driven(10, 0.0), 0.5) == (0.0, True)
    assert record.at(driven(11, 0.5), 0.5) == (0.5, True)
    assert record.contradiction == ""


@pytest.mark.parametrize(("tick", "output_A", "ordered_A"), [(10, 0.5, 0.0), (11, 0.0, 0.5), (11, 0.3, 0.5)])
def test_another_output_is_a_contradiction(record, tick, output_A, ordered_A):
    assert record.at(driven(tick, output_A), 0.5) == (ordered_A, False)
    assert f"drove {output_A:g} A in its tick {tick}, but {ordered_A:g} A was ordered" in record.contradiction


def test_while_a_command_was_under_way_either_current_may_have_flowed():
    """Read up to tick 10; the reply to the command says that tick 13 was over: executed before 11, 12, 13 or 14."""
    record = OrderRecord()
    record.read_until(10)
    record.changed(0.2, 13)
    for tick, output_A in ((11, 0.2), (12, 0.5), (13, 0.5), (13, 0.2)):
        assert record.at(driven(tick, output_A), 0.5) == (output_A, True)
    assert record.at(driven(14, 0.5), 0.5) == (0.5, True)
    assert record.at(driven(10, 0.2), 0.5) == (0.2, True)
    assert not record.contradiction
    assert record.at(driven(12, 0.35), 0.5) == (0.2, False)


def test_several_commands_in_one_unread_stretch():
    record = OrderRecord()
    record.read_until(10)
    for before_A, last in ((0.1, 12), (0.2, 12), (0.3, 15)):
        record.changed(before_A, last)
    assert record.at(driven(9, 0.1), 0.4) == (0.1, True)
    assert record.at(driven(11, 0.1), 0.4) == (0.1, True)
    assert record.at(driven(14, 0.3), 0.4) == (0.3, True)
    assert record.at(driven(14, 0.4), 0.4) == (0.4, True)
    assert record.at(driven(16, 0.4), 0.4) == (0.4, True)
    assert record.at(driven(14, 0.2), 0.4)[1] is False
    assert record.at(driven(16, 0.3), 0.4)[1] is False


@pytest.mark.parametrize("quality", [Quality.STALE, Quality.TRIPPED, Quality.STALE | Quality.RETRIED])
def test_what_is_old_or_tripped_is_not_compared(record, quality):
    assert record.at(driven(11, 0.9, quality), 0.5) == (0.5, True)
    assert record.contradiction == ""


def test_a_source_that_does_not_tell_is_believed(record):
    assert record.at(driven(11, None), 0.5) == (0.5, True)


def test_a_register_rounds_to_a_microampere(record):
    assert record.at(driven(11, 0.500001), 0.5) == (0.5, True)
    assert record.at(driven(11, 0.500002), 0.5) == (0.5, False)


def test_the_last_currents_are_kept():
    record = OrderRecord()
    for k in range(2 * KEPT):
        record.read_until(k)
        record.changed(k / 1000, k)
    for k in range(2 * KEPT - 10, 2 * KEPT):
        assert record.at(driven(k, k / 1000), 9.0) == (k / 1000, True)
