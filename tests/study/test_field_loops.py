"""Coercive field, bias and remanence against loops whose figures are known by construction."""

import numpy as np
import pytest

from smarig.study.field_loops import field_loops, field_sentences


class Record(dict):
    """The columns of a run, and its units."""

    def __init__(self, u, y, input_unit="Oe", unit="emu"):
        super().__init__(input=np.asarray(u), position=np.asarray(y))
        self.input_unit, self.unit = input_unit, unit

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
    found = field_loops([Record(*loop(coercive, bias, offset=offset, start=start))])
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
    found = field_loops([Record(u, y)])
    assert found.loops == 3
    mean, low, high = found.coercive
    assert low <= mean <= high
    assert mean == pytest.approx(150.0, abs=5.0)
    (said,) = field_sentences(found)
    assert said.startswith("Coercive field 15")
    assert "means of 3 loops" in said


@pytest.mark.parametrize(("input_unit", "unit"), [("degC", "mm"), ("V", "mm"), ("Oe", "%"), ("V", "V")])
def test_other_data_have_none(input_unit, unit):
    assert field_loops([Record(*loop(150.0), input_unit, unit)]) is None
    assert field_sentences(None) == []


def test_a_field_of_one_sign_has_none():
    u, y = loop(150.0)
    assert field_loops([Record(u + 2000.0, y)]) is None


@pytest.mark.parametrize(
    ("input_unit", "unit"), [("kV/cm", "uC/cm^2"), ("V", "uC"), ("T", "A m^2"), ("A/m", "T")]
)
def test_magnets_and_ferroelectrics_have_them(input_unit, unit):
    assert field_loops([Record(*loop(150.0), input_unit, unit)]).coercive[0] == pytest.approx(150.0, abs=1.0)
