"""What cannot give transformation temperatures gets one sentence and exit status 2, and no number."""

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.core import UsageError
from smarig.exchange import import_file
from smarig.transformation import branch_tangents, headline, run_figures, transformation_temperatures
from transformation.known_loops import known_loop, run_of

RAMP = np.linspace(0.0, 100.0, 101)


def curve(u, middle=50.0, span=10.0):
    return np.clip((u - middle) / span + 0.5, 0, 1)


def loop(u=RAMP):
    """One clean cycle with A_s, A_f, M_s, M_f = 50, 60, 50, 40."""
    return np.concatenate([u, u[::-1]]), np.concatenate([curve(u, 55), curve(u[::-1], 45)])


BOTH = loop()
BAD = {
    "one branch": ((RAMP, curve(RAMP)), {}, "only a heating branch"),
    "no full loop": (
        (np.concatenate([RAMP, RAMP[:39:-1]]), np.concatenate([curve(RAMP), curve(RAMP[:39:-1])])),
        {},
        "not a full one",
    ),
    "flat": ((BOTH[0], 0.001 * BOTH[0]), {}, "flat"),
    "noise alone": ((BOTH[0], np.random.default_rng(1).normal(0, 1, BOTH[0].size)), {}, "no full loop"),
    "few readings": (loop(np.linspace(0, 100, 9)), {}, "9 readings"),
    "constant output": ((BOTH[0], np.ones(BOTH[0].size)), {}, "constant"),
    "constant temperature": ((np.full(50, 20.0), np.arange(50.0)), {}, "no full loop"),
    "no readings": ((np.empty(0), np.empty(0)), {}, "no row"),
    "all nan": ((np.full(50, np.nan), np.arange(50.0)), {}, "no row"),
    "current": (BOTH, {"unit": "A", "quantity": "current"}, "needs? a temperature"),
    "voltage": (BOTH, {"unit": "V", "quantity": "voltage"}, "voltage"),
    "two wires": (BOTH, {"unit": "K", "quantity": "T1 - T2"}, "two wires"),
}


@pytest.mark.parametrize("case", BAD)
def test_each_gets_one_clear_sentence(case):
    (u, y), more, says = BAD[case]
    run = run_of(u, y, **more)
    with pytest.raises(UsageError, match=says):
        transformation_temperatures(run)
    assert headline(run) == {}


def test_the_good_loop_beside_them_is_exact():
    found = run_figures(run_of(*BOTH))
    values = [found.means[n].value for n in ("A_s", "A_f", "M_s", "M_f")]
    assert values == pytest.approx([50, 60, 50, 40], abs=0.05)
    assert found.means["stroke"].value == pytest.approx(1.0)
    assert found.means["span"].value == pytest.approx(20, abs=0.1)
    assert found.means["width"].value == pytest.approx(10, abs=0.1)


@pytest.mark.parametrize("factor", [1e-310, 1e120])
def test_numbers_that_no_wire_gives_are_refused(factor):
    u, y = loop()
    with pytest.raises(UsageError, match="which no wire gives"):
        run_figures(run_of(u, factor * y))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_an_array_with_a_reading_that_is_no_number_is_refused(value):
    y = curve(RAMP)
    y[50] = value
    with pytest.raises(UsageError, match="not a number"):
        branch_tangents(RAMP, y)


def test_rows_of_a_run_without_a_value_are_left_out_and_stated():
    u, y = loop()
    y[[20, 120]] = np.nan
    found = run_figures(run_of(u, y))
    assert found.notes[0].startswith("2 of 202 rows without temperature or output")
    assert found.means["A_s"].value == pytest.approx(50, abs=0.05)


@pytest.mark.parametrize(("top", "missing"), [(58.0, ("A_f",)), (61.0, ("A_f",))])
def test_a_plateau_that_was_not_reached_gives_no_temperature(top, missing):
    """Heating ends in the middle of the transformation, or just behind it: nothing is extrapolated."""
    u = np.linspace(0, top, 120)
    up, down = curve(u, 55), np.minimum(curve(u, 55)[-1], curve(u, 45))
    found = run_figures(run_of(np.concatenate([u, u[::-1]]), np.concatenate([up, down[::-1]])))
    for name in missing:
        assert name not in found.means
        assert (
            "levelled off" in found.cycles[0].why_not[name] or "readings lie" in found.cycles[0].why_not[name]
        )
    assert "span" not in found.means
    assert "A_s" in found.means


def test_a_branch_that_stops_halfway_does_not_borrow_the_plateau_it_left_behind():
    """Cooling stops at half of the stroke. The next heating starts there, flat, but that is no martensite."""
    down = np.linspace(100, 45, 120)
    up = down[::-1]
    y = np.concatenate([curve(down, 45), np.maximum(0.5, curve(up, 55))])
    found = run_figures(run_of(np.concatenate([down, up]), y))
    assert "M_f" not in found.means


def test_a_run_that_is_one_of_several_is_named(tmp_path):
    runs = [run_of(*BOTH, name="good"), run_of(RAMP, curve(RAMP), name="half")]
    with pytest.raises(UsageError, match="^half contains no full loop"):
        transformation_temperatures(runs)


@pytest.mark.parametrize(("mapping", "file"), [("sma_staircase", "sma_staircase/test.csv")])
def test_the_command_ends_with_status_2_and_one_line(shared_data, tmp_path, capsys, mapping, file):
    out = tmp_path / "stairs.run.sqlite"
    import_file(shared_data / file, format="csv", mapping=mapping, out=out)
    page = tmp_path / "page.html"
    assert cli(["transformation", str(out), "-o", str(page)]) == 2
    err = capsys.readouterr().err
    assert "current (A)" in err
    assert err.strip().count("\n") == 0
    assert not page.exists()


def test_a_loop_without_noise_has_a_narrow_interval_and_no_zero_division():
    found = run_figures(run_of(*loop(np.linspace(0, 100, 40))))
    assert np.isfinite([d.ci95 for d in found.means.values()]).all()
    made = known_loop(0, noise=0.0, drift=0.0)
    assert np.isfinite([d.ci95 for d in run_figures(run_of(made.u, made.y)).means.values()]).all()
