"""A stopped blind benchmark can be continued, and its table does not depend on the interruption."""

import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from benchmark.blind.records import record
from benchmarks import diagnosis
from benchmarks.boxes import draw_box
from smarig.cli import run as smarig
from smarig.core.errors import UsageError


@pytest.fixture
def computed_boxes(monkeypatch):
    """Boxes that were computed, in order; a box's answer follows from its seed and number alone."""
    numbers = []

    def trial(seed, number, part=None):
        numbers.append(number)
        if (seed + number) % 2:
            return record(number, "walking", {"walking": 1.0 + number}, seconds=float(seed + number))
        return record(number, "silent", seconds=float(seed + number))

    monkeypatch.setattr(diagnosis, "trial", trial)
    return numbers


def kept(out):
    return [json.loads(line) for line in out.read_text(encoding="utf-8").splitlines()]


def test_answers_are_kept_as_they_come_one_line_each(computed_boxes, tmp_path, monkeypatch):
    out = tmp_path / "answers.jsonl"
    lengths = []
    plain = diagnosis.trial

    def watched(*given):
        lengths.append(len(kept(out)) if out.exists() else 0)
        return plain(*given)

    monkeypatch.setattr(diagnosis, "trial", watched)
    diagnosis.run(boxes=4, seed=3, out=out)
    assert lengths == [0, 1, 2, 3]
    assert [(r["seed"], r["number"]) for r in kept(out)] == [(3, 0), (3, 1), (3, 2), (3, 3)]


def test_a_finished_file_is_read_and_nothing_computed(computed_boxes, tmp_path):
    out = tmp_path / "answers.jsonl"
    first = diagnosis.run(boxes=5, out=out)
    computed_boxes.clear()
    text = out.read_text(encoding="utf-8")
    assert diagnosis.run(boxes=5, out=out) == first
    assert computed_boxes == []
    assert out.read_text(encoding="utf-8") == text


def test_only_what_is_missing_is_computed(computed_boxes, tmp_path):
    out = tmp_path / "answers.jsonl"
    diagnosis.run(boxes=3, out=out)
    assert computed_boxes == [0, 1, 2]
    computed_boxes.clear()
    more = diagnosis.run(boxes=6, out=out)
    assert computed_boxes == [3, 4, 5]
    assert more == diagnosis.run(boxes=6)


def test_of_a_file_with_more_boxes_only_the_requested_are_scored(computed_boxes, tmp_path):
    out = tmp_path / "answers.jsonl"
    diagnosis.run(boxes=6, out=out)
    assert diagnosis.run(boxes=3, out=out) == diagnosis.run(boxes=3)


def test_answers_of_another_seed_are_not_taken(computed_boxes, tmp_path):
    out = tmp_path / "answers.jsonl"
    diagnosis.run(boxes=2, seed=1, out=out)
    computed_boxes.clear()
    found = diagnosis.run(boxes=2, seed=2, out=out)
    assert computed_boxes == [0, 1]
    assert found["seed"] == 2
    computed_boxes.clear()
    assert diagnosis.run(boxes=2, seed=1, out=out) == diagnosis.run(boxes=2, seed=1)
    assert computed_boxes == [0, 1]


def test_a_half_written_last_line_is_computed_again(computed_boxes, tmp_path):
    out = tmp_path / "answers.jsonl"
    whole = diagnosis.run(boxes=4, out=out)
    text = out.read_text(encoding="utf-8")
    out.write_text(text[: text.rstrip().rfind("\n") + 30], encoding="utf-8")
    computed_boxes.clear()
    assert diagnosis.run(boxes=4, out=out) == whole
    assert computed_boxes == [3]


def test_an_answer_after_a_half_written_line_is_kept_too(computed_boxes, tmp_path):
    out = tmp_path / "answers.jsonl"
    diagnosis.run(boxes=4, out=out)
    text = out.read_text(encoding="utf-8")
    out.write_text(text[: text.rstrip().rfind("\n") + 30], encoding="utf-8")
    diagnosis.run(boxes=4, out=out)
    computed_boxes.clear()
    diagnosis.run(boxes=4, out=out)
    assert computed_boxes == []


def test_answers_that_come_in_another_order_give_the_same_table(computed_boxes, tmp_path, monkeypatch):
    out = tmp_path / "answers.jsonl"
    plain = diagnosis.run(boxes=6, seed=4)

    def backwards(seed, numbers, workers, dask, part):
        yield from (diagnosis.trial(seed, k) for k in reversed(numbers))

    monkeypatch.setattr(diagnosis, "_answers", backwards)
    assert diagnosis.run(boxes=6, seed=4, out=out) == plain
    assert [r["number"] for r in kept(out)] == [5, 4, 3, 2, 1, 0]
    computed_boxes.clear()
    assert diagnosis.run(boxes=6, seed=4, out=out) == plain
    assert computed_boxes == []


def test_several_workers_give_the_same_table_as_one(computed_boxes, tmp_path, monkeypatch):
    """Threads stand for processes here: what is tested is that every answer finds its place."""
    pools = []

    def pool(workers, mp_context):
        pools.append(workers)
        return ThreadPoolExecutor(workers)

    monkeypatch.setattr(diagnosis, "ProcessPoolExecutor", pool)
    out = tmp_path / "answers.jsonl"
    assert diagnosis.run(boxes=9, workers=3, out=out) == diagnosis.run(boxes=9)
    assert pools == [3]
    assert sorted(r["number"] for r in kept(out)) == list(range(9))


def test_an_interrupted_benchmark_keeps_its_answers(computed_boxes, tmp_path, monkeypatch):
    out = tmp_path / "answers.jsonl"
    plain = diagnosis.trial

    def dies(seed, number, part=None):
        if number == 2:
            raise KeyboardInterrupt
        return plain(seed, number)

    monkeypatch.setattr(diagnosis, "trial", dies)
    with pytest.raises(KeyboardInterrupt):
        diagnosis.run(boxes=4, out=out)
    monkeypatch.setattr(diagnosis, "trial", plain)
    computed_boxes.clear()
    assert diagnosis.run(boxes=4, out=out) == diagnosis.run(boxes=4)
    assert computed_boxes[:2] == [2, 3]


@pytest.mark.parametrize("out", [Path("/dev/full"), Path("/dev/zero"), Path()])
def test_what_is_no_file_keeps_no_answers(computed_boxes, out):
    with pytest.raises(UsageError, match="is not a file that can hold answers"):
        diagnosis.run(boxes=1, out=out)
    assert computed_boxes == []


@pytest.mark.long("takes two seconds")
def test_boxes_with_an_unknown_effect_alone_can_be_requested(computed_boxes, tmp_path):
    out = tmp_path / "answers.jsonl"
    found = diagnosis.run(boxes=80, seed=7, out=out, left_out=True)
    assert found["boxes"] == len(computed_boxes) > 1
    assert all(draw_box(7, number).left_out for number in computed_boxes)
    rest = set(range(80)) - set(computed_boxes)
    assert not any(draw_box(7, number).left_out for number in rest)
    computed_boxes.clear()
    diagnosis.run(boxes=80, seed=7, out=out)
    assert set(computed_boxes) == rest, "what is known is not asked again"


def test_quick_is_a_few_boxes(computed_boxes):
    assert diagnosis.run(quick=True)["boxes"] == len(computed_boxes) == diagnosis.QUICK


@pytest.mark.parametrize("wrong", [{"boxes": 0}, {"workers": 0}])
def test_no_boxes_or_no_workers_are_refused(computed_boxes, wrong):
    with pytest.raises(UsageError, match=r"At least one box and one worker"):
        diagnosis.run(**wrong)
    assert computed_boxes == []


def test_the_command_line_hands_its_options_on(computed_boxes, tmp_path, capsys):
    out = tmp_path / "answers.jsonl"
    status = smarig(["benchmark", "diagnosis", "--boxes", "3", "--seed", "5", "-o", str(out), "--json"])
    found = json.loads(capsys.readouterr().out)
    assert status == 0
    assert (found["boxes"], found["seed"]) == (3, 5)
    assert len(kept(out)) == 3


@pytest.mark.parametrize(
    "option",
    [["--boxes", "3"], ["--seed", "1"], ["--workers", "2"], ["--out", "answers.jsonl"], ["--left-out"]],
)
def test_options_of_another_benchmark_are_refused_with_a_sentence(capsys, option):
    status = smarig(["benchmark", "forward", *option])
    out, err = capsys.readouterr()
    assert status == 2
    assert out == ""
    assert f"'forward' has no {option[0]}." in err


def test_without_the_extra_a_cluster_is_refused_with_how_to_get_it(computed_boxes, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"smarig\[scale\]"):
        diagnosis.run(boxes=1, dask="tcp://nowhere:1")
