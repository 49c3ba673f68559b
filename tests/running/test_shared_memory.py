"""The shared memory of a run: what is written is read, what is half written is not believed, a stop is never lost."""

import mmap
import multiprocessing
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest

from smarig.core import UsageError
from smarig.running.shared_memory import (
    _DESCRIPTION,
    _RING,
    RECORD,
    RECORDS,
    SAMPLE_FIELDS,
    SIZE,
    SharedMemory,
)

N = len(SAMPLE_FIELDS)


@pytest.fixture
def raw() -> mmap.mmap:
    return mmap.mmap(-1, SIZE)


@pytest.fixture
def memory(raw) -> SharedMemory:
    return SharedMemory(raw)


def test_samples_come_back_in_order_with_their_fields(memory):
    for k in range(1, 6):
        memory.add(*(k + j / 100 for j in range(N)))
    found, newest, lost = memory.samples(2)
    assert (newest, lost) == (5, 0)
    assert found["t_s"].tolist() == [3.0, 4.0, 5.0]
    assert found["quality"].tolist() == pytest.approx([k + 0.1 for k in (3, 4, 5)])
    assert memory.samples(5)[0].size == 0


def test_overwritten_samples_count_as_lost(memory):
    for k in range(1, RECORDS + 101):
        memory.add(*[float(k)] * N)
    found, newest, lost = memory.samples(0)
    assert newest == RECORDS + 100
    assert lost + found.size == newest
    assert found.size == RECORDS - 1
    assert np.diff(found["t_s"]).tolist() == [1.0] * (RECORDS - 2)


@pytest.mark.parametrize("part", ["first number", "last number", "being overwritten"])
def test_a_torn_record_is_not_believed(memory, raw, part):
    for k in range(1, 4):
        memory.add(*[float(k)] * N)
    place = _RING + 2 * RECORD.size
    if part == "first number":
        struct.pack_into("@Q", raw, place, 2 + RECORDS)
    elif part == "last number":
        struct.pack_into("@Q", raw, place + RECORD.size - 8, 2 + RECORDS)
    found, _, lost = memory.samples(0) if part != "being overwritten" else _read_while_overtaken(memory, raw)
    assert 2.0 not in found["t_s"].tolist()
    assert lost == 1


def _read_while_overtaken(memory, raw):
    """The count goes on between the copy of the records and the end of the reading."""

    class Overtaking(SharedMemory):
        reads = 0

        @property
        def newest(self) -> int:
            Overtaking.reads += 1
            return 3 if Overtaking.reads == 1 else RECORDS + 1  # so that the writer may be at record 2

    found, newest, lost = Overtaking(raw).samples(1)
    return found, newest, lost


def _write(path: str, ready, enough) -> None:
    with open(path, "r+b") as file:  # noqa: PTH123
        memory = SharedMemory(mmap.mmap(file.fileno(), SIZE))
        ready.set()
        k = 0
        while not enough.is_set():
            for _ in range(1000):
                k += 1
                memory.add(*[float(k)] * N)


def test_a_reader_beside_a_writer_of_full_speed_sees_only_whole_records_and_counts_the_others(tmp_path):
    path = tmp_path / "memory"
    path.write_bytes(bytes(SIZE))
    context = multiprocessing.get_context("spawn")
    ready, enough = context.Event(), context.Event()
    writer = context.Process(target=_write, args=(str(path), ready, enough))
    writer.start()
    assert ready.wait(60)
    with path.open("r+b") as file:
        memory = SharedMemory(mmap.mmap(file.fileno(), SIZE))
        after = seen = lost = 0
        for _ in range(600):
            found, newest, missed = memory.samples(after)
            rows = found.view(np.float64).reshape(-1, N)
            assert (rows == rows[:, :1]).all()  # every field is of the same sample
            times = found["t_s"]
            assert newest >= after
            assert np.all(np.diff(times) > 0)
            assert not times.size or after < times[0] <= times[-1] <= newest
            seen, lost, after = seen + times.size, lost + missed, newest
    enough.set()
    writer.join(60)
    assert writer.exitcode == 0
    assert after > 0
    assert seen + lost == after
    assert seen > 0


def test_texts_come_back_and_damaged_ones_are_empty(memory, raw):
    memory.prepare({"wire": "Δ <b>\x00\udc80 😀"})
    assert memory.valid
    assert memory.description() == {"wire": "Δ <b>\x00\udc80 😀"}
    raw[_DESCRIPTION + 12] ^= 1
    assert memory.description() == {}


@pytest.mark.parametrize("text", [b"[" * 5000, b"\xff\xfe\xff", b"[1, 2]", b"9" * 5000, b"NaN", b""])
def test_hostile_texts_with_a_right_checksum_are_empty(memory, raw, text):
    struct.pack_into("@II", raw, _DESCRIPTION, len(text), zlib.crc32(text))
    raw[_DESCRIPTION + 8 : _DESCRIPTION + 8 + len(text)] = text
    assert memory.description() == {}


def test_a_length_beyond_the_memory_is_no_text(memory, raw):
    struct.pack_into("@II", raw, _DESCRIPTION, 2**32 - 1, 0)
    assert memory.description() == {}


def test_a_status_replaces_the_one_before(memory):
    assert memory.status() == {}
    for k in range(5):
        memory.write_status({"step_number": k})
        assert memory.status() == {"step_number": k}


def test_a_text_too_long_is_refused_and_not_replaced_by_nothing(memory):
    with pytest.raises(UsageError, match="at most 8184"):
        memory.prepare({"out": "x" * 9000})


def test_requests_come_back_with_who_made_them(memory):
    before = memory.requests()
    memory.ask("pause", "Ä" * 300)
    (number, request, who), stop = memory.requests()
    assert number != before[0][0]
    assert (request, who) == ("pause", "Ä" * 100)  # 200 bytes
    assert stop == before[1]


def test_a_stop_is_not_lost_to_what_others_ask_after_it(memory):
    memory.ask("stop", "one")
    memory.ask("continue", "another")
    assert [request[1:] for request in memory.requests()] == [("continue", "another"), ("stop", "one")]


def test_the_same_request_twice_is_two_requests(memory):
    memory.ask("pause", "a")
    first = memory.requests()
    memory.ask("pause", "a")
    assert memory.requests()[0][0] != first[0][0]


def test_the_description_of_the_largest_names_fits(tmp_path: Path, memory):
    from smarig.running import PanelRunInfo
    from smarig.running.status_text import description_of

    name = "\u4e00" * 400
    out = Path("/" + "/".join(["\u4e00" * 60] * 22))  # 4003 bytes
    info = PanelRunInfo(name, name, name, "twin", False, "mm", 0.1, 5, 300.0, out, name)
    memory.prepare(description_of(info, pid=5, start_epoch=1.0, command=["smarig", "run", name]))
    assert memory.description()["out"] == str(out)
