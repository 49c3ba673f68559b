"""The values that a finding states are those of the effect: every effect, with and without intervals."""

import pytest

from smarig.diagnosis.comparison.commanded.commanded_diagnosis import _parameters
from smarig.diagnosis.comparison.finding import Finding
from smarig.plant import Effect, effect_types


def middle(kind) -> Effect:
    """The effect with each parameter between its bounds."""
    return kind(**{p.name: p.lower + 0.4 * (p.upper - p.lower) for p in kind.parameters})


@pytest.mark.parametrize("kind", effect_types(), ids=lambda kind: kind.name)
def test_a_finding_states_the_values_of_its_effect(kind):
    effect = middle(kind)
    fitted = {f"{kind.name}.{name}": value for name, value in effect.values.items()}
    intervals = {key: (value - 0.05 * abs(value), value + 0.05 * abs(value)) for key, value in fitted.items()}
    stated = Finding(kind.name, 0.95, dict(_parameters(effect, intervals, fitted))).to_json()
    assert stated["name"] == kind.name
    assert list(stated["parameters"]) == [p.name for p in kind.parameters]
    for p in kind.parameters:
        said = stated["parameters"][p.name]
        assert said["value"] == effect.values[p.name]
        assert said["unit"] == p.unit
        low, high = said["ci95"]
        assert p.lower <= low <= said["value"] <= high <= p.upper
