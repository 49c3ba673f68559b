"""Verification: errors of a model at settled points along the whole history, with the encoder's zero as an
offset."""

from dataclasses import replace

import numpy as np
import pytest

from identification.made_runs import driven_run, fod_run, made_run
from smarig.core.errors import DataError, UsageError
from smarig.identification.identify import identify
from smarig.identification.verify import verify
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.replay import simulate, simulate_samples
from smarig.runner import Session

WALK = [0.0, *np.random.default_rng(5).uniform(0, 174.1, 40)]
TWO_WALK = [*np.random.default_rng(6).uniform(-185, 185, 40)]


@pytest.fixture(scope="module")
def one():
    return identify(fod_run("one_e"), "exponential").model


@pytest.fixture(scope="module")
def two():
    psi = Preisach(thesis_surface("two_e"), "anhysteretic").y
    return identify(fod_run("two_e", offset=-psi), "exponential").model


def test_a_right_model_has_no_error_and_a_wrong_one_the_right_error(one):
    found = verify(one, driven_run("one_e", WALK)).to_json()
    (run,) = found["runs"]
    assert found["unit"] == "mm"
    assert run["n"] == 41
    assert run["rms"] < 1e-5
    measured = driven_run("one_c", WALK)
    (run,) = verify(one, measured).to_json()["runs"]
    error = Preisach.from_surface(thesis_surface("one_e")).simulate(WALK) - measured.points()[1]
    assert run["rms"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-4)
    assert run["max_abs"] == pytest.approx(np.abs(error).max(), rel=1e-4)
    assert run["nrmse"] == pytest.approx(run["rms"] / np.ptp(measured.points()[1]), rel=1e-9)


def test_points_at_the_ends_of_the_loop_alone_make_no_model_good(one):
    """Where both branches meet, every model is right. One level between them is a test."""

    def noisy(inputs):
        exact = Preisach.from_surface(thesis_surface("one_e")).simulate(inputs)
        return made_run(inputs, exact + 0.01 * np.random.default_rng(4).standard_normal(exact.size))

    ends = verify(one, noisy([0.0, 174.1] * 6)).runs[0]
    assert ends.in_loop == 0
    assert ends.verdict.level == "fair"
    assert any(w.startswith("No point lies inside the loop") for w in ends.warnings)
    between = verify(one, noisy([0.0, 174.1] * 6 + [80.0])).runs[0]
    assert between.in_loop == 1
    assert not any("inside the loop" in w for w in between.warnings)


def test_power_up_in_a_named_state_is_a_known_zero(two):
    psi = Preisach(thesis_surface("two_e"), "anhysteretic").y
    run = driven_run("two_e", TWO_WALK, initial="anhysteretic", offset=-psi)
    judged = verify(two, run).runs[0]
    assert judged.offset_kind == "known"
    assert abs(psi) > 1  # or the offset would not show
    assert judged.settled.rms < 1e-4


def test_a_model_in_another_zero_is_moved_by_its_output_in_the_initial_state():
    model = identify(fod_run("two_e"), "exponential").model  # outputs from −16.5 to 18.1 deg
    psi = Preisach(thesis_surface("two_e"), "anhysteretic").y
    run = driven_run("two_e", TWO_WALK, initial="anhysteretic", offset=-psi, encoder_zero="power-up")
    judged = verify(model, run).runs[0]
    assert judged.offset_kind == "known"
    assert judged.offset == pytest.approx(-psi, abs=1e-3)
    assert judged.settled.rms < 1e-4


def test_an_unknown_zero_is_fitted_by_one_number_and_reported(one):
    run = driven_run("one_e", WALK, offset=3.0, encoder_zero="zeroed at 12 s")
    judged = verify(one, run).runs[0]
    assert judged.offset_kind == "fitted"
    assert judged.offset == pytest.approx(3.0, abs=1e-4)
    assert judged.settled.rms < 1e-4
    assert any("one additive offset was fitted" in w for w in judged.warnings)
    with pytest.raises(DataError, match="does not state"):
        verify(one, run, offset="known")


def test_the_same_session_has_the_same_zero():
    session = {"start_epoch": 7.0, "encoder_zero": "zeroed at 12 s"}
    model = identify(fod_run("one_e", offset=2.0, **session), "exponential").model
    same = driven_run("one_e", WALK, offset=2.0, **session)
    other = driven_run("one_e", WALK, offset=2.0, **{**session, "encoder_zero": "zeroed at 99 s"})
    assert verify(model, same).runs[0].offset_kind == "known"
    assert verify(model, same).runs[0].offset == 0.0
    assert verify(model, same).runs[0].settled.rms < 1e-4
    assert verify(model, other).runs[0].offset_kind == "fitted"


def test_a_selection_evaluates_a_part_along_the_whole_history(one):
    run = fod_run("one_c")
    parts = [verify(one, run, select=f"curve%2=={k}").runs[0] for k in (0, 1)]
    assert sum(p.settled.n for p in parts) == 65
    whole = verify(one, run).runs[0]
    error = whole.predicted - whole.measured
    for part in parts:
        assert part.settled.rms == pytest.approx(np.sqrt(np.mean(error[part.counted] ** 2)), rel=1e-9)
        assert np.array_equal(part.predicted, whole.predicted)
        assert part.settled.nrmse == pytest.approx(part.settled.rms / np.ptp(run.points()[1]))
    with pytest.raises(UsageError, match="finds no point"):
        verify(one, run, select="curve == 77")


def test_points_before_the_memory_is_known_do_not_count(one):
    inputs = [80, 20, 60, 0, 100, 30, 70]
    y = driven_run("one_e", [150, 10, *inputs]).points()[1][2:]
    judged = verify(one, made_run(inputs, y, initial=None)).runs[0]
    assert judged.settled.n == 4
    assert np.isnan(judged.predicted[:3]).all()
    assert any("3 points come before" in w for w in judged.warnings)
    with pytest.raises(DataError, match="memory at its start is unknown"):
        verify(one, made_run(inputs[:3], y[:3], initial=None))


def later(run, by_s):
    """The same run with its clock shifted."""
    steps = [replace(s, t_start_s=s.t_start_s + by_s, t_end_s=s.t_end_s + by_s) for s in run.steps]
    return replace(run, columns={**run.columns, "t_s": run["t_s"] + by_s}, steps=tuple(steps))


def test_a_run_that_continues_another_needs_it(one):
    whole = driven_run("one_e", [0, 100, 40, 80, 50, 90, 60])
    y = whole.points()[1]
    first = made_run([0, 100, 40], y[:3], start_epoch=1.0)
    second = made_run([80, 50, 90, 60], y[3:], initial="continued", start_epoch=1.0)
    second = later(second, first["t_s"][-1] + 1)
    together = verify(one, [first, second]).runs[1]
    assert together.settled.n == 4
    assert together.settled.rms < 1e-4
    with pytest.raises(DataError, match="give the run before it"):
        verify(one, second)


def test_reversal_curves_start_from_positive_saturation_each():
    s = thesis_surface("two_c")
    truth = Preisach.from_surface(s)
    rows = []
    for number, reversal in enumerate((100.0, 0.0, -100.0, -185.0)):
        truth.reset("positive")
        truth.step(reversal)
        rows.append((185.0, s.y_upper, -1))
        rows += [(u, truth.step(u), number) for u in np.linspace(reversal, 185, 12).tolist()]
    u, y, step = np.array(rows).T
    run = made_run(u, y, unit="deg", initial=None, protocol="first_order_reversal_curves")
    run = type(run)(run.path, run.meta, run.columns | {"step": step}, (), ())
    judged = verify(identify(run, "table").model, run).runs[0]
    assert judged.settled.n == 48
    assert judged.settled.rms < 1e-9
    assert judged.warnings == ()


def test_along_every_sample_and_at_settled_points_agree(one):
    run = driven_run("one_e", WALK)
    assert np.array_equal(simulate_samples(one, run), simulate(one, run))
    gaps = type(run)(run.path, run.meta, run.columns | {"input": run["input"].copy()}, run.steps, ())
    gaps["input"][[3, 7]] = np.nan
    along = simulate_samples(one, gaps)
    assert along[3] == along[2]
    assert np.isfinite(along).all()


def test_units_must_agree_and_the_range_is_watched(one, two):
    with pytest.raises(DataError, match="measures in 'deg'"):
        verify(one, driven_run("two_e", TWO_WALK, initial="anhysteretic"))
    beyond = driven_run("one_e", [0, 100, 200, 50])
    assert any("outside the model's range" in w for w in verify(one, beyond).runs[0].warnings)
    celsius = made_run([0, 100, 50], [0, 1, 2], input={"quantity": "temperature", "unit": "degC"})
    with pytest.raises(UsageError, match="'degC'"):
        verify(one, celsius)


def test_a_model_and_runs_may_be_paths_and_anything_else_is_one_sentence(one, tmp_path):
    with Session("one_wire_twin", seed=1) as session:
        run = session.run("step_currents", {"currents_A": "0.4,0.6"}, tmp_path / "a.run.sqlite")
    one.save(tmp_path / "m.model.json")
    by_path = verify(tmp_path / "m.model.json", tmp_path / "a.run.sqlite").to_json()["runs"]
    assert by_path[0]["rms"] == verify(one, [run]).to_json()["runs"][0]["rms"]
    for wrong in (5, None, [one]):
        with pytest.raises(UsageError, match="Give runs, as load_run returns them, or the paths"):
            verify(one, wrong)


def test_a_share_of_a_range_that_is_only_noise_is_no_figure(one):
    """Of a wire that stands still the range is that of its noise, and an error of a millimetre 'over 1000 %' of it."""
    still = [0.0, 4.0] * 15  # one_e moves by a hundredth of a count
    noise = 0.01 * np.random.default_rng(3).standard_normal(len(still))
    errors = verify(one, made_run(still, 1.0 + noise)).runs[0]
    assert errors.noise_floor == pytest.approx(0.01, rel=0.3)
    assert errors.settled.rms > 0
    assert errors.to_json()["nrmse"] is None
    assert errors.settled.share_text == "the measured range is no more than its noise"
    moving = verify(one, made_run(still, 1.0 + noise + 0.1 * np.array(still) / 4)).runs[0]
    assert moving.noise_floor == pytest.approx(errors.noise_floor, rel=0.1)
    assert moving.settled.share_text.endswith(" % of the measured range")


def test_one_point_has_no_range(one):
    errors = verify(one, made_run([90.0], [3.0], initial="negative")).runs[0]
    assert errors.to_json()["nrmse"] is None
    assert errors.verdict.text == "the output does not move, and the noise is unknown"
