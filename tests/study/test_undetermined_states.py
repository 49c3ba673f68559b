"""Held-out data that enter states which no fitted data determine: missing knowledge, and never a change.

The wires are sums of relays, drawn or on a line. Their readings have noise and nothing else, unless a test adds it.
"""

import numpy as np
import pytest

from smarig.study import study
from smarig.study.candidate_models import PROPORTIONAL_PART
from smarig.study.study_options import StudyOptions

PATHS = {
    "inner turn": (25, 95, 50, 90, 25),
    "deep turn": (25, 95, 62, 90, 25),
    "full loops": (25, 95, 25, 95, 25),
}


def path(turns, rows=80):
    parts = [np.linspace(a, b, rows, endpoint=False) for a, b in zip(turns, turns[1:])]
    return np.concatenate([*parts, [turns[-1]]])


def relays(kind):
    if kind == "on a line":
        th = np.linspace(-2, 2, 60)
        return 67 + 5 * th, 53 + 5 * th
    rng = np.random.default_rng(5)
    return rng.normal(67, 5, 4000), rng.normal(53, 5, 4000)


def output(kind, u, shift=0.0):
    up, down = relays(kind)
    on, y = np.zeros(up.size, dtype=bool), []
    for v in u:
        on = np.where(v > up + shift, True, np.where(v < down + shift, False, on))
        y.append(4 * on.mean())
    return np.array(y)


def written(file, u, y, header="time_s,temperature_C,displacement_mm"):
    noisy = y + 0.01 * np.random.default_rng(1).standard_normal(u.size)
    rows = np.column_stack([0.5 * np.arange(u.size), u, noisy])
    np.savetxt(file, rows, delimiter=",", header=header, comments="", fmt="%.5f")
    return file


def studied(folder, u, y, *, diagnose=False):
    return study([written(folder / "loop.csv", u, y)], folder / "out", StudyOptions(diagnose=diagnose))


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("kind", ["on a line", "drawn"])
@pytest.mark.parametrize(("turns", "at"), [("inner turn", 50), ("deep turn", 62)])
def test_a_turn_inside_the_fitted_loop_is_missing_knowledge(tmp_path, kind, turns, at):
    u = path(PATHS[turns])
    result = studied(tmp_path, u, output(kind, u))
    found = result.undetermined
    assert found is not None
    assert found.share > 0.9
    assert min(abs(turn - at) for turn in found.turns) < 1
    (said,) = [s for s in result.sentences() if "missing knowledge" in s]
    assert said.startswith("Up to "), "one model of all data follows noise that lasts, too"
    assert f"turn at {at}" in said
    assert not any("changed" in s for s in result.reasons)


def test_a_split_within_an_inner_loop_does_not_hide_missing_knowledge(tmp_path):
    """One model of both parts is that of the whole record: the split adds no curve by which it is smoothed."""
    u = path((25, 95, 25, 69, 55, 95, 25), rows=150)
    result = studied(tmp_path, u, output("on a line", u))
    assert result.undetermined is not None
    assert result.undetermined.explains
    assert not any("changed" in s for s in result.reasons)


def test_the_diagnosis_does_not_take_it_for_a_cause(tmp_path):
    u = path(PATHS["inner turn"])
    result = studied(tmp_path, u, output("on a line", u), diagnose=True)
    assert result.diagnosis is not None
    assert result.diagnosis.verdict.names == ()
    assert any("missing knowledge" in s for s in result.sentences())


def test_a_wire_that_changed_is_not_excused(tmp_path):
    u = path((25, 95, 25, 95, 25, 95, 25))
    y = output("drawn", u)
    later = np.arange(u.size) > u.size // 2
    y[later] = output("drawn", u, shift=6.0)[later]
    result = studied(tmp_path, u, y)
    assert result.undetermined is None
    assert result.verdict == "poor"
    assert not any("missing knowledge" in s for s in result.sentences())


@pytest.mark.long("takes two seconds")
def test_a_longer_record_of_a_changed_wire_does_not_outvote_the_fitted_one(tmp_path):
    first, second = path((25, 95, 25), rows=60), path((25, 95, 25, 95, 25), rows=400)
    files = [
        written(tmp_path / "a.csv", first, output("drawn", first)),
        written(tmp_path / "b.csv", second, output("drawn", second, shift=2.0)),
    ]
    result = study(files, tmp_path / "out", StudyOptions(diagnose=False))
    assert result.split is not None
    assert result.split.kind == "run"
    assert result.undetermined is None


def test_full_loops_leave_nothing_open(tmp_path):
    u = path(PATHS["full loops"])
    assert studied(tmp_path, u, output("drawn", u)).undetermined is None


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("beyond", [0.002, 0.005])
@pytest.mark.parametrize("ends", [(0.0, 1.0), (0.5, 3.5)])
def test_fitted_data_may_never_saturate_a_model_of_all_rows(tmp_path, ends, beyond):
    # of a current no start is assumed; the widest loop comes last, after inner loops
    low, high = ends
    turns = np.array([0, 1, 0, 1, 0.4, 0.85, -beyond, 1 + beyond])
    u = 25 + 70 * path(turns, rows=60)
    file = tmp_path / "loop.csv"
    current = low + (u - 25) / 70 * (high - low)
    written(file, current, output("on a line", u), "time_s,current_A,displacement_mm")
    result = study([file], tmp_path / "out", StudyOptions(diagnose=False))
    assert result.split is not None
    assert result.split.kind == "time"
    found = result.undetermined
    assert found is not None
    assert found.share > 0.9
    inner = low + 0.4 * (high - low)
    assert min(abs(turn - inner) for turn in found.turns) < 0.05 * (high - low)


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("inner", [(0.62, 0.58), (0.63, 0.6)])
def test_full_loops_are_those_of_the_fitted_data(tmp_path, inner):
    first, second = inner
    u = 25 + 70 * path(np.array([0, 1, 0, 1, 0, 1, 0, first, 0, second, 0, 1, 0]), rows=40)
    result = studied(tmp_path, u, output("on a line", u))
    simple = result.sentences()[1]
    assert "the fitted data do not turn inside the loop, but the held-out data do" in simple


def test_noise_that_no_model_removes_is_not_counted_against_missing_knowledge(tmp_path):
    """The noise is half of the held-out error: one model of all rows still leaves that half."""
    u = path(PATHS["inner turn"])
    y = output("drawn", u) + 0.02 * np.random.default_rng(3).standard_normal(u.size)
    found = studied(tmp_path, u, y).undetermined
    assert found is not None
    assert found.explains


@pytest.mark.long("takes five seconds")
def test_inner_loops_of_the_fitted_data_are_no_full_loops(tmp_path):
    """Two wires, one 8 K later: a curve is as good as a model of both, whatever the data hold."""
    u = path((25, 95, 50, 90, 25, 95, 25))
    files = [written(tmp_path / f"{k}.csv", u, output("drawn", u, shift=8.0 * k)) for k in range(2)]
    result = study(files, tmp_path / "out", StudyOptions(diagnose=False))
    (curve,) = [s for s in result.sentences() if "simple curve" in s]
    assert "although the fitted data hold inner loops" in curve


def test_part_of_an_error_may_be_missing_knowledge(tmp_path):
    """A held-out part that turns anew, after a zero that jumped: the turn is said, and that nothing changed is not."""
    u = path(PATHS["deep turn"])
    y = output("drawn", u)
    y[u.size * 3 // 5 :] += 0.3
    result = studied(tmp_path, u, y)
    found = result.undetermined
    assert found is not None
    assert not found.explains
    assert any("missing knowledge:" in s for s in result.sentences())
    assert not any("nothing need have changed" in s for s in result.sentences())


def test_a_part_proportional_to_the_input_hides_no_missing_knowledge(tmp_path):
    """No measure has that part: what a plain model misses everywhere is no reason to see no new error."""
    u = path(PATHS["inner turn"])
    result = studied(tmp_path, u, output("drawn", u) - 0.006 * u, diagnose=True)
    assert result.evaluation is not None
    assert result.evaluation.best.name == PROPORTIONAL_PART
    assert not result.evaluation.plain.misses_held_out
    assert result.undetermined is not None
    assert result.undetermined.explains
    assert not any("changed" in s for s in result.reasons)


@pytest.mark.long("takes ten seconds")
def test_a_part_proportional_to_the_input_excuses_no_change(tmp_path):
    u = path((25, 95, 25, 95, 25, 95, 50, 90, 25))
    y = output("drawn", u) - 0.006 * u
    y[u.size * 3 // 5 :] += 0.3
    result = studied(tmp_path, u, y, diagnose=True)
    assert result.undetermined is None or not result.undetermined.explains


def test_fitted_data_without_any_error_are_no_division_by_zero(tmp_path, monkeypatch):
    """As of a curve that was digitised: the model passes through every fitted reading."""
    module = "smarig.study.undetermined_states"
    monkeypatch.setattr(f"{module}.root_mean_square", lambda _: 0.0)
    u = path(PATHS["deep turn"])
    found = studied(tmp_path, u, output("drawn", u)).undetermined
    assert found is not None
    assert not found.explains
