"""Clocks and counts of cycles go on over the split of one record into a fitted and a held-out part."""

import numpy as np
import pytest

from smarig.measurement import input_records
from smarig.record import load_run
from smarig.study import study
from smarig.study.study_options import StudyOptions

pytestmark = pytest.mark.usefixtures("few_readings")
SIGMA = 0.03


def clamped(cycles=6, rows=50, shift=0.8, saturating=False):
    """Time, temperature and force of a clamped wire whose load cell drifts by ``shift`` over the record."""
    ramp = np.linspace(30.0, 100.0, rows, endpoint=False)
    u = np.append(np.tile(np.concatenate([ramp, 130.0 - ramp]), cycles), 30.0)
    rising = np.append(np.tile(np.repeat([1.0, -1.0], rows), cycles), -1.0)
    force = 5 + 5 * np.tanh((u - np.where(rising > 0, 75.0, 59.0)) / 5)
    t = np.arange(u.size, dtype=float)
    share = t / t[-1]
    drift = shift * ((1 - np.exp(-3 * share)) / (1 - np.exp(-3)) if saturating else share)
    return t, u, force + drift + SIGMA * np.random.default_rng(4).standard_normal(u.size)


def written(folder, rows, start=0.0):
    t, u, y = rows
    file = folder / "drift.csv"
    table = np.column_stack([t + start, u, y])
    np.savetxt(file, table, delimiter=",", header="t_s,T_degC,force_N", comments="", fmt="%.5f")
    return file


@pytest.mark.long("takes ten seconds", cases=("True-0.0", "False-50000.0"))
@pytest.mark.parametrize(("saturating", "start"), [(False, 0.0), (True, 0.0), (False, 5e4)])
def test_a_drift_goes_on_in_the_held_out_part(tmp_path, saturating, start):
    file = written(tmp_path, clamped(saturating=saturating), start)
    result = study([file], tmp_path / "out", StudyOptions())
    assert result.split is not None
    assert result.split.kind == "time"
    assert result.diagnosis is not None
    assert "output_drift" in result.diagnosis.verdict.names  # time and cycles go together in one record
    assert result.evaluation is not None
    assert result.evaluation.best.rms < 2.5 * SIGMA
    assert result.verdict == "good"


def test_a_jump_of_the_first_part_stays_in_the_held_out_part(tmp_path):
    """The bench was touched half way through the first part: the rest of the record is shifted throughout."""
    t, u, y = clamped(shift=0.0)
    file = written(tmp_path, (t, u, y + 0.5 * (t > 0.3 * t[-1])))
    result = study([file], tmp_path / "out", StudyOptions())
    assert result.diagnosis is not None
    assert result.diagnosis.verdict.names == ("output_jump",)
    assert result.evaluation is not None
    assert result.evaluation.best.rms < 2.5 * SIGMA


def test_a_jump_within_the_held_out_part_is_told(tmp_path):
    """The clamp slips in the fifth of six cycles: nothing that is fitted shows it."""
    t, u, y = clamped(shift=0.0)
    result = study([written(tmp_path, (t, u, y + 0.8 * (t > 430)))], tmp_path / "out", StudyOptions())
    assert result.split is not None
    assert result.split.kind == "time"
    assert result.diagnosis is not None
    assert result.diagnosis.verdict.names == ("output_jump",)
    (effect,) = result.diagnosis.effects()
    at = next(p for p in effect["parameters"].values() if p["unit"] == "h")
    assert 3600 * at["value"] == pytest.approx(430, abs=8)
    assert effect["parameters"]["amplitude"]["value"] == pytest.approx(0.8, rel=0.1)
    assert "A cause was found: output_jump." in result.sentences()[2]


@pytest.mark.parametrize("change", ["nothing", "within the noise", "shifted input", "softer"])
def test_what_is_no_jump_within_the_held_out_part_is_not_called_one(tmp_path, change):
    t, u, y = clamped(shift=0.0)
    late, other = t > 430, clamped(shift=0.0)
    if change == "within the noise":
        y = y + 0.3 * SIGMA * late
    elif change == "shifted input":
        u = np.where(late, other[1] + 5.0, u)
    elif change == "softer":
        y = np.where(late, 0.85 * y, y)
    result = study([written(tmp_path, (t, u, y))], tmp_path / "out", StudyOptions())
    assert result.diagnosis is not None
    assert "output_jump" not in [f.name for f in result.diagnosis.findings]


def test_the_part_that_goes_on_states_when_the_record_began_and_its_cycles(tmp_path):
    file = written(tmp_path, clamped(), start=100.0)
    result = study([file], tmp_path / "out", StudyOptions(diagnose=False))
    assert result.split is not None
    first, second = (load_run(part[0].path) for part in (result.split.train, result.split.held_out))
    (alone,), (_, joined) = input_records([second]), input_records([first, second])
    for record in (alone, joined):
        assert record.elapsed[0] == pytest.approx(second["t_s"][0] - 100.0)
        assert record.cycle[0] == pytest.approx(round(record.cycle[0] * 2) / 2, abs=0.05)
        assert record.cycle[0] > 2
    assert alone.cycle[0] == pytest.approx(joined.cycle[0], abs=0.05)


@pytest.fixture(scope="module")
def imported(tmp_path_factory):
    folder = tmp_path_factory.mktemp("imported")
    file = written(folder, clamped(cycles=3))
    return study([file], folder / "out", StudyOptions(diagnose=False)).tables[0].run


@pytest.mark.parametrize(
    "stated", [None, 3, {}, {"began_s": "x", "cycles": None}, {"began_s": 1e308}, {"cycles": -4}]
)
def test_what_a_file_states_wrongly_is_as_if_it_stated_nothing(imported, stated):
    stating = {**imported.meta["imported"], "continues_at": stated}
    (record,) = input_records([imported.with_meta(imported=stating)])
    assert record.elapsed[0] == 0
    assert record.cycle[0] == 0


def test_a_copy_under_another_name_and_clock_is_left_out(tmp_path):
    first = written(tmp_path, clamped(cycles=3))
    second = tmp_path / "copy.csv"
    header, *rows = first.read_text(encoding="utf-8").splitlines()
    later = [f"{float(row.split(',')[0]) + 5000},{row.split(',', 1)[1]}" for row in rows]
    second.write_text("\n".join([header, *later]) + "\n", encoding="utf-8")
    result = study([first, second], tmp_path / "out", StudyOptions(diagnose=False))
    assert [table.title for table in result.tables] == ["drift"]
    assert "readings of drift" in result.left_out["copy"]


def test_a_model_of_full_loops_is_good_for_full_loops(tmp_path):
    file = written(tmp_path, clamped(cycles=4, rows=200, shift=0.0))
    result = study([file], tmp_path / "out", StudyOptions(diagnose=False))
    assert result.verdict == "good"
    first, second, *_ = result.sentences()
    assert "good for full loops; inner loops were not tested" in first
    assert "no data turn inside the loop" in second
