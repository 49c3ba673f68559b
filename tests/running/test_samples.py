"""Samples in shared memory: each is read whole, or counted as lost."""

import numpy as np
import pytest

from smarig.running import SAMPLES, memory_layout, runs_in_progress
from smarig.running.run_in_progress import AnnouncedFile
from tests.running.made import feed, made, sample

pytestmark = pytest.mark.usefixtures("folder")
RECORDS = memory_layout.RECORDS


def test_writer_and_reader_have_one_layout():
    values = (7, 0.5, -1, 0.1, 0.2, 0.3, 0.4, -12, 0.6, 0.7, 0.8, 9, 7)
    packed = memory_layout.RECORD.pack(*values)
    assert np.frombuffer(packed, memory_layout.STORED)[0].tolist() == values
    assert memory_layout.REQUESTS_AT + 2 * memory_layout.REQUEST_SIZE <= memory_layout.DESCRIPTION_AT


def test_every_field_arrives_in_its_place():
    with made() as listener:
        feed(listener, 1, 2)
        listener.sample(sample(3), None, 1.5)
        (run,) = runs_in_progress()
        found, newest, lost = run.samples()
    assert (newest, lost, found.dtype) == (3, 0, SAMPLES)
    row = dict(zip(SAMPLES.names or (), found[1].tolist(), strict=True))
    assert np.isnan(row.pop("temperature_degC"))
    assert row == {
        "number": 2,
        "t_s": 0.2,
        "step": 3,
        "current_command_A": 0.5,
        "current_A": 2e-3,
        "voltage_V": 4e-3,
        "input_K": 52.0,
        "counts": -2,
        "position": 6e-3,
        "ambient_degC": 22.0,
        "quality": 4,
    }
    assert found[2]["step"] == -1


@pytest.mark.parametrize(
    ("written", "after", "kept", "lost"),
    [
        (0, 0, 0, 0),
        (10, 0, 10, 0),
        (10, 10, 0, 0),
        (10, 7, 3, 0),
        (10, 99, 0, 0),
        (10, -5, 10, 0),
        (RECORDS, 0, RECORDS, 0),
        (RECORDS + 1, 0, RECORDS, 1),
        (3 * RECORDS + 5, RECORDS, RECORDS, RECORDS + 5),
        (RECORDS + 100, 50, RECORDS, 50),
        (RECORDS + 100, RECORDS + 90, 10, 0),
    ],
)
def test_what_is_kept_and_what_is_lost(written, after, kept, lost):
    with made() as listener:
        feed(listener, 1, written)
        (run,) = runs_in_progress()
        found = run.samples(after)
    assert (len(found.samples), found.lost) == (kept, lost)
    assert found.newest == max(written, after)
    assert found.samples["number"].tolist() == list(range(found.newest - kept + 1, found.newest + 1))
    np.testing.assert_array_equal(found.samples["current_A"], found.samples["number"] * 1e-3)


def test_a_sample_that_is_overwritten_while_it_is_read_is_lost(monkeypatch):
    """The writer goes round the ring between the two looks of the reader."""
    with made() as listener:
        feed(listener, 1, 100)
        (run,) = runs_in_progress()
        looks, records = [], AnnouncedFile._records

        def interrupted(self, first, last):
            found = records(self, first, last)
            if not looks:
                feed(listener, 101, RECORDS + 40)
            looks.append(found)
            return found

        monkeypatch.setattr(AnnouncedFile, "_records", interrupted)
        found = run.samples()
    assert found.lost == 40
    assert found.samples["number"].tolist() == list(range(41, 101))


@pytest.mark.parametrize("field", ["number", "number_again"])
def test_half_a_record_is_lost(field, folder):
    with made() as listener:
        feed(listener, 1, 10)
        (run,) = runs_in_progress()
        at = memory_layout.record_at(5) + (0 if field == "number" else memory_layout.RECORD.size - 8)
        with next(folder.iterdir()).open("r+b") as file:
            file.seek(at)
            file.write(memory_layout.WORD.pack(5 + RECORDS))
        found = run.samples()
    assert found.lost == 1
    assert found.samples["number"].tolist() == [1, 2, 3, 4, 6, 7, 8, 9, 10]
