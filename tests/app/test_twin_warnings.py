"""What a characterisation of a twin says about the twin's own hysteresis."""

import re
from types import SimpleNamespace

import pytest

from smarig.app.characterise import _twin_warnings


def run_on(actuator, *, twin=True, effects=()):
    return SimpleNamespace(
        twin=twin, info=SimpleNamespace(actuator=actuator, actuator_values={}, effects=effects)
    )


@pytest.mark.parametrize(
    ("actuator", "words"),
    [
        ("gorbet_one_wire", "This twin's hysteresis is the surface one_e of Table 5.1"),
        (
            "thermomechanical_two_wire",
            r"\(thermomechanical_two_wire\) follows Brinson's .* no Preisach operator",
        ),
    ],
)
def test_each_kind_of_twin_is_named(actuator, words):
    (sentence,) = _twin_warnings({"a": run_on(actuator), "b": run_on(actuator)}, hidden=False)
    assert re.search(words, sentence)


def test_hardware_has_none():
    assert _twin_warnings({"a": run_on("gorbet_one_wire", twin=False)}, hidden=False) == []


def test_a_twin_with_an_effect_is_not_said_to_fit_by_construction():
    faulty = run_on("gorbet_one_wire", effects=("ambient_drift(swing_K=3)",))
    (sentence,) = _twin_warnings({"a": faulty}, hidden=False)
    assert "injected effects ambient_drift" in sentence
    assert "by construction" not in sentence
    (healthy,) = _twin_warnings({"a": run_on("gorbet_one_wire")}, hidden=False)
    assert "by construction" in healthy
