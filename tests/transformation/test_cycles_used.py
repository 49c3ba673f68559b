"""Which cycles the figures come from, when a drift is given, and what a run that did not settle says of its lag."""

import numpy as np
import pytest

from smarig.core import UsageError
from smarig.transformation import run_figures, transformation_temperatures
from transformation.known_loops import run_of
from transformation.test_cycles_and_stress import U, cycle, cycles


def joined(*parts):
    return tuple(np.concatenate(columns) for columns in zip(*parts))


def test_all_figures_come_from_the_same_cycles():
    """The first of three cycles heats an untransformed wire: its cooling alone must not enter the means."""
    u, y = cycles(3, -2.0)
    y = y.copy()
    y[: U.size] = y[U.size]  # its heating does nothing
    found = run_figures(run_of(u, y))
    assert found.averaged == (2, 3)
    assert set(found.counts.values()) == {2}
    mean = {name: d.value for name, d in found.means.items()}
    assert mean["span"] == pytest.approx(mean["A_f"] - mean["M_f"], abs=1e-9)
    middle = (mean["A_s"] + mean["A_f"] - mean["M_s"] - mean["M_f"]) / 2
    assert mean["width"] == pytest.approx(middle, abs=1e-9)
    assert mean["M_s"] == pytest.approx(50 - 3.0, abs=0.1)
    assert any(
        note == "All figures are those of cycles 2 to 3; cycle 1 has no A_s and A_f." for note in found.notes
    )
    assert "means over cycles 2 to 3" in str(transformation_temperatures(found.run))


def test_what_each_of_the_other_cycles_lacks_is_said_of_it_alone():
    """The second of four cycles cools without a change, the others after the first heat without one."""
    u, y = (part.reshape(4, 2, U.size).copy() for part in cycles(4, 0.0))
    y[1, 1] = y[1, 0, -1]
    y[2:, 0] = y[2:, 1, :1]
    found = run_figures(run_of(u.ravel(), y.ravel()))
    assert found.averaged == (1,)
    said = "All figures are those of cycle 1; cycle 2 has no M_s and M_f; cycles 3 to 4 have no A_s and A_f."
    assert said in found.notes


def test_three_cycles_that_scatter_have_no_drift_and_say_why():
    parts = [cycle(shift=s, noise=0.005, seed=k) for k, s in enumerate((0.0, 3.0, -1.0))]
    found = run_figures(run_of(*joined(*parts)))
    assert "A_s" not in found.drift
    assert "scatter too much to determine a drift of A_s" in found.no_drift
    assert "drift not given: the cycles scatter" in str(transformation_temperatures(found.run))


def test_cycles_between_other_temperatures_do_not_enter_a_drift():
    """The second of four cycles turns 8 K earlier: it is a full cycle, but not alike."""
    parts = [cycle(shift=-0.5 * k, noise=0.002, seed=k) for k in range(4)]
    short = parts[1][0] <= 92
    parts[1] = (parts[1][0][short], parts[1][1][short])
    found = run_figures(run_of(*joined(*parts)))
    assert len(found.averaged) == 4
    assert found.drift["A_s"].n == 3
    two = run_figures(run_of(*joined(*parts[1:3], parts[3])))
    assert two.drift == {}
    assert "3 cycles between the same temperatures, and there are 2" in two.no_drift


NAMES = ("A_s", "A_f", "M_s", "M_f")


def test_the_lag_of_the_heating_model_widens_the_interval():
    """0.5 K/s and τ = 5.3 s: ± 2.7 K on each branch, in opposite directions, so twice that in the width."""
    u, y = cycle(noise=0.002)
    settled = run_of(u, y)
    t = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(u)))]) / 0.5
    fast = run_of(u, y)
    fast.columns["t_s"] = t
    modelled = fast.with_meta(
        actuator="gorbet_one_wire",
        input={"quantity": "temperature", "unit": "degC", "from": "heating model"},
        source="twin",  # whose wire obeys that model: its heat loss is known
    )

    def half(found, name):
        low, high = found.means[name].ci95
        return (high - low) / 2

    plain, lagged, measured = run_figures(settled), run_figures(modelled), run_figures(fast)
    for name in ("A_s", "A_f", "M_s", "M_f"):
        assert half(lagged, name) == pytest.approx(0.95 * 0.5 * 5.33, rel=0.06)
    assert half(lagged, "width") == pytest.approx(2 * 0.95 * 0.5 * 5.33, rel=0.06)
    assert half(measured, "A_s") == pytest.approx(half(plain, "A_s"))
    assert any("the thermometer is later lowers A_s and A_f by 0.5 K" in note for note in measured.notes)
    assert any("widened by ± rate × τ" in note for note in lagged.notes)


@pytest.mark.parametrize("later", ["thermometer", "wire"])
def test_which_way_a_lag_of_the_thermometer_or_of_the_wire_shifts_each_temperature(later):
    """4 s at 0.5 K/s are 2 K: a thermometer that is later lowers A_s and A_f and raises M_s and M_f."""
    u, y = cycle(noise=0.002)
    u, y = np.tile(u, 2), np.tile(y, 2)
    t = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(u)))]) / 0.5 + 1e-9 * np.arange(u.size)
    late = {"thermometer": u, "wire": y}[later]
    late[:] = np.interp(t - 4.0, t, late.copy())
    lagging, exact = run_of(u, y), run_of(*(np.tile(x, 2) for x in cycle(noise=0.002)))
    lagging.columns["t_s"] = t
    shift = {n: run_figures(lagging).means[n].value - run_figures(exact).means[n].value for n in NAMES}
    sign = -1.0 if later == "thermometer" else 1.0
    for name in NAMES:
        assert shift[name] == pytest.approx(sign * (2.0 if name[0] == "A" else -2.0), abs=0.6), name


def test_a_refusal_gives_the_reasons_of_all_branches():
    flat = [np.linspace(0, 100, 60), np.linspace(100, 0, 60)] * 3
    u = np.concatenate(flat)
    with pytest.raises(UsageError) as error:
        run_figures(run_of(u, 1e-3 * np.random.default_rng(0).standard_normal(u.size)))
    assert str(error.value).count("Cycle ") == 6
