"""An effect injected by independent code is found, and without an effect there is no finding."""

import pytest

from diagnosis.boxes_opened import answer

pytestmark = pytest.mark.long("takes twenty seconds each")


@pytest.mark.parametrize("number", [3, 4, 6])
def test_it_finds_nothing_if_nothing_is_hidden(number):
    found = answer(number)
    assert found.verdict.word == "silent"
    assert found.effects() == []
    assert not found.extended


def test_it_finds_nothing_in_an_unusual_but_classical_density_or_noise():
    assert answer(6, "hard_null").verdict.word == "silent"


def test_walking_is_named_with_its_strength_and_the_extended_model_predicts_better():
    found = answer(1, "walking")
    assert found.verdict.word == "named"
    assert found.verdict.names == ("walking",)
    strength = found.effects()[0]["parameters"]["percent_per_cycle"]
    assert strength["ci95"][0] < 0.3 < strength["ci95"][1]
    assert found.gain is not None
    assert found.gain.extended < found.gain.base
    assert found.gain.removable_share is not None
    assert found.gain.removable_share > 0.5
    assert found.model.effects[0]["name"] == "walking"


def test_what_no_channel_shows_is_reported_as_invisible():
    invisible = answer(3).not_identifiable
    assert {"wire_lag", "sensor_lag", "latent_heat"} <= set(invisible)
