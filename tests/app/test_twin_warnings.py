"""What a characterisation of a twin says about the twin's own hysteresis."""

import re
from types import SimpleNamespace

import pytest

from smarig.app.characterise import _twin_warnings


def run_on(actuator, *, twin=True):
    return SimpleNamespace(twin=twin, info=SimpleNamespace(actuator=actuator))


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
