"""Coercive field, bias and remanence against loops whose figures are known by construction."""

from types import SimpleNamespace

import numpy as np
import pytest

from smarig.study.field_loops import field_loops, field_sentences


class Record(dict):
    """The columns of a run, and its units."""

    def __init__(self, u, y, input_unit="Oe", unit="emu", **conditions):
        super().__init__(input=np.asarray(u), position=np.asarray(y))
        self.input_unit, self.unit = input_unit, unit
        means = {name: {"mean": value, "unit": of} for name, (value, of) in conditions.items()}
        self.info = SimpleNamespace(conditions=means)

    def has(self, name):
        return name in self


def loop(coercive, bias=0.0, *, cycles=1, offset=0.0, rows=400, noise=0.0, start=1):
    """tanh branches moved by ± the coercive field, about a bias and an offset of the output."""
    u, y = [], []
    for _ in range(cycles):
        for way in (start, -start):
            h = np.linspace(-way * 1000.0, way * 1000.0, rows)
            u.append(h)
            y.append(2.0 * np.tanh((h - bias - way * coercive) / 120.0) + offset)
    out = np.concatenate(y)
    return np.concatenate(u), out + noise * np.random.default_rng(5).standard_normal(out.size)


@pytest.mark.parametrize("start", [1, -1])
@pytest.mark.parametrize(
    ("coercive", "bias", "offset"), [(150.0, 0.0, 0.0), (60.0, 35.0, 0.7), (300.0, -80.0, -3.0)]
)
def test_the_figures_are_those_of_the_loop(coercive, bias, offset, start):
    (found,) = field_loops([Record(*loop(coercive, bias, offset=offset, start=start))])
    remanence = np.tanh((coercive - bias) / 120) - np.tanh((-coercive - bias) / 120)
    assert found.loops == 1
    assert found.coercive[0] == pytest.approx(coercive, abs=1.0)
    assert found.bias[0] == pytest.approx(bias, abs=1.0)
    assert found.remanence[0] == pytest.approx(remanence, rel=0.02)
    assert found.saturation[0] == pytest.approx(2.0, rel=0.01)


def test_several_loops_give_their_range_and_inner_ones_do_not_count():
    u, y = loop(150.0, cycles=3, noise=0.01)
    inner = np.linspace(-1000, -200, 50)
    u = np.concatenate([u, inner, inner[::-1]])
    y = np.concatenate([y, np.full(100, -2.0)])
    (found,) = field_loops([Record(u, y)])
    assert found.loops == 3
    mean, low, high = found.coercive
    assert low <= mean <= high
    assert mean == pytest.approx(150.0, abs=5.0)
    (said,) = field_sentences([found])
    assert said.startswith("Coercive field 15")
    assert "means of 3 loops" in said


@pytest.mark.parametrize(("input_unit", "unit"), [("degC", "mm"), ("V", "mm"), ("Oe", "%"), ("V", "V")])
def test_other_data_have_none(input_unit, unit):
    assert field_loops([Record(*loop(150.0), input_unit, unit)]) == ()
    assert field_sentences(()) == []


def test_a_field_of_one_sign_has_none():
    u, y = loop(150.0)
    assert field_loops([Record(u + 2000.0, y)]) == ()


@pytest.mark.parametrize(
    ("input_unit", "unit"), [("kV/cm", "uC/cm^2"), ("V", "uC"), ("T", "A m^2"), ("A/m", "T")]
)
def test_magnets_and_ferroelectrics_have_them(input_unit, unit):
    (found,) = field_loops([Record(*loop(150.0), input_unit, unit)])
    assert found.coercive[0] == pytest.approx(150.0, abs=1.0)


@pytest.mark.parametrize(
    ("name", "levels", "unit"), [("temperature", (80.0, 150.0, 290.0), "K"), ("stress", (10.0, 60.0), "MPa")]
)
def test_each_condition_has_figures_of_its_own(name, levels, unit):
    at = {level: 400.0 - level for level in levels}
    runs = [
        Record(*loop(coercive), **{name: (level * (1 + 1e-4 * k), unit)})
        for k in range(2)
        for level, coercive in at.items()
    ]
    found = field_loops(runs)
    assert [loops.loops for loops in found] == [2] * len(levels)
    for loops, (level, coercive) in zip(found, at.items()):
        assert loops.coercive[0] == pytest.approx(coercive, abs=1.0)
        assert loops.to_json()["conditions"] == {name: {"value": pytest.approx(level), "unit": unit}}
    assert field_sentences(found)[0].startswith(f"{name.capitalize()} {levels[0]:g} {unit}: coercive field")


@pytest.mark.parametrize("step", [50.0, 110.0, -130.0])
def test_reversal_curves_have_no_closed_loop(step):
    """Each comes from saturation in one step; what lies between was not read."""
    u, y = [], []
    for reversal in np.arange(1000.0, -1001.0, -abs(step)):
        h = np.arange(reversal, 1001.0, 25.0)
        u.append(h)
        y.append(np.tanh((h - 150.0 * (h < 900)) / 120.0) - 1e-4 * reversal)
    h, m = np.concatenate(u), np.concatenate(y)
    sign = np.sign(step)
    assert field_loops([Record(sign * h, sign * m)]) == ()


@pytest.mark.parametrize("change", ["open", "one end"])
def test_a_loop_that_is_not_closed_has_none(change):
    u, y = loop(150.0)
    rows = u < 200.0 if change == "one end" else np.ones(u.size, dtype=bool)
    y = y + (np.linspace(0, 1.5, u.size) if change == "open" else 0.0)
    assert field_loops([Record(u[rows], y[rows])]) == ()
