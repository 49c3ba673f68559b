"""Hostile inputs of the positive identification: each gives one clear error message or a correct result."""

import numpy as np
import pytest

from identification.made_runs import PARTITION, driven_run, fod_inputs, made_run
from smarig.core.errors import DataError, SmarigError
from smarig.identification.identify import identify
from smarig.preisach.hysteresis.fod_surface import FodSurface
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.theory.extended.moving_operator import MovingPreisach


def changed(change):
    run = driven_run("one_c", fod_inputs(PARTITION["one"]), seed=1)
    return made_run([s.target for s in run.settled], [change(s.position) for s in run.settled])


@pytest.mark.long("takes a second")
def test_an_output_of_the_other_sign_has_the_same_measure():
    falling, rising = identify(changed(lambda y: -y), "positive"), identify(changed(lambda y: y), "positive")
    assert any("falls while the input rises" in w for w in falling.model.warnings)
    assert np.allclose(falling.positive.masses, rising.positive.masses, atol=1e-9)


@pytest.mark.parametrize("kind", ["constant", "exponential"])
def test_an_output_of_the_wrong_sign_is_reported(kind):
    with pytest.raises(DataError, match="sign"):
        identify(changed(lambda y: -y), kind)


@pytest.mark.parametrize("zero", [0.0, 1e6, 1e9])
def test_a_far_encoder_zero_does_not_make_a_positive_measure_negative(zero):
    assert identify(changed(lambda y: y + zero), "positive").density.M_P


def test_a_hysteresis_that_is_not_finite_is_refused():
    for make in (
        lambda: FodSurface("constant", (np.nan, 1.0, 1.0, 1.0), 0.0, 10.0, 0.0, 1.0),
        lambda: FodSurface("constant", (1.0, 1.0, 1.0, 1.0), 0.0, 10.0, 0.0, np.nan),
        lambda: Preisach.from_table([0.0, 5.0, np.inf], [0.0, 5.0, np.inf], np.tril(np.ones((3, 3)))),
        lambda: Preisach.from_table([], [], np.empty((0, 0))),
        lambda: Preisach.from_measure([1e308, 1.0], [-1e308, 0.0], [1e308, 1e308]),
    ):
        with pytest.raises(SmarigError):
            make()


def test_nan_is_refused_by_the_moving_model_too():
    with pytest.raises(DataError, match="NaN"):
        MovingPreisach(thesis_surface("one_e"), -0.1).simulate([np.nan, 1.0])


def test_words_for_inputs_are_refused():
    with pytest.raises(SmarigError, match="numbers"):
        Preisach(thesis_surface("one_c")).simulate(["a"])
