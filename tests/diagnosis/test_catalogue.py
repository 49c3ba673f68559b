"""Every effect of the catalogue, injected by independent code, is found where it is identifiable, and only
there.

Box 16 has a wide hysteresis and box 1 a narrow one; both have low noise. Boxes 21 and 29 have two wires.
What a classical density represents completely (the gauge theorem), no record of settled positions at one
load can show.
"""

import pytest

from benchmarks.blind.score_table import confusable, is_correct_variable
from benchmarks.boxes.box_effects import EFFECTS
from diagnosis.boxes_opened import answer

VISIBLE = {  # effect: (box, times its usual strength, channels)
    "accommodation": (1, 1, ()),
    "ambient_drift": (1, 1, ("ambient",)),
    "amplifier_gain": (1, 1, ("current",)),
    "backlash": (1, 1, ()),
    "convection": (1, 1, ("transients", "current", "voltage", "ambient")),
    "creep": (16, 1, ()),
    "cross_talk": (29, 1, ()),
    "dead_zone": (1, 1, ("current",)),
    "fatigue": (1, 2, ()),
    "latent_heat": (1, 1, ("transients",)),
    "noncongruency": (16, 1, ()),
    "resistance_phase": (1, 1, ("voltage",)),
    "saturation": (1, 1, ("current",)),
    "sensor_lag": (1, 1, ("transients",)),
    "settling": (16, 1, ()),
    "slack": (2, 2, ("voltage",)),
    "slip": (16, 1, ()),
    "stress_coupling": (21, 2, ()),
    "temperature_memory": (16, 1, ()),
    "thermal_expansion": (1, 4, ()),
    "walking": (16, 1, ()),
    "wire_lag": (1, 1, ("transients",)),
}
INVISIBLE = {
    "amplifier_gain": (1, 1, ()),
    "convection": (1, 1, ()),
    "coulomb_friction": (16, 2, ("voltage",)),
    "dead_zone": (1, 1, ()),
    "eccentricity": (28, 3, ()),  # the pulley turns too little
    "end_conduction": (16, 2, ("voltage",)),
    "r_phase": (16, 2, ("voltage",)),
}
LONG = {
    "ambient_drift",
    "accommodation",
    "amplifier_gain",
    "backlash",
    "convection",
    "coulomb_friction",
    "creep",
    "cross_talk",
    "dead_zone",
    "eccentricity",
    "end_conduction",
    "fatigue",
    "latent_heat",
    "noncongruency",
    "r_phase",
    "resistance_phase",
    "saturation",
    "sensor_lag",
    "settling",
    "slack",
    "slip",
    "stress_coupling",
    "temperature_memory",
    "thermal_expansion",
    "walking",
    "wire_lag",
}


# What an earlier engine missed; not measured again with the present one.
MISSED = {
    "amplifier_gain": "the current shows it, but held-out positions are predicted slightly worse",
    "convection": "the error is at the noise, and its gain stays below 18 nats",
    "cross_talk": "held-out runs bear it out by R = 0.27 only",
    "stress_coupling": "resistance_phase is likelier, and held-out runs do not bear it out",
}
where_there_is_time = pytest.mark.long("takes a minute")


def selected(names):
    """All of them; those that take long where there is time (``SMARIG_LONG``, as in ``.ci/long``)."""
    return [pytest.param(name, marks=where_there_is_time) if name in LONG else name for name in names]


def test_every_effect_is_covered():
    assert set(VISIBLE) | set(INVISIBLE) == set(EFFECTS)


@pytest.mark.parametrize("effect", selected(VISIBLE))
def test_an_effect_that_shows_is_named_or_in_the_set(effect, request):
    if effect in MISSED:
        request.applymarker(pytest.mark.xfail(reason=MISSED[effect]))
    number, times, channels = VISIBLE[effect]
    found = answer(number, effect, channels, times=times)
    assert found.verdict.word in ("named", "ambiguous")
    assert effect in found.verdict.names
    assert effect not in found.not_identifiable


@pytest.mark.parametrize("effect", selected(INVISIBLE))
def test_an_effect_that_a_density_takes_up_gets_no_name_at_all(effect):
    number, times, channels = INVISIBLE[effect]
    assert answer(number, effect, channels, times=times).verdict.word in ("silent", "not_identifiable")


@pytest.mark.parametrize("effect", selected(["creep", "ambient_drift", "dead_zone"]))
def test_without_its_name_in_the_catalogue_the_variable_is_reported(effect):
    number, times, channels = VISIBLE[effect]
    found = answer(number, effect, channels, (effect,), times=times)
    assert found.verdict.word == "unknown"
    assert is_correct_variable(effect, found.verdict.depends_on)
    assert not found.extended


@where_there_is_time
def test_without_its_name_a_lag_is_taken_for_a_similar_effect_only():
    """A late sensor and a slow wire form one group: the verdict names one of the group, or the dependence on
    rate."""
    number, times, channels = VISIBLE["sensor_lag"]
    found = answer(number, "sensor_lag", channels, ("sensor_lag",), times=times)
    if found.verdict.word == "unknown":
        assert is_correct_variable("sensor_lag", found.verdict.depends_on)
    else:
        assert found.verdict.names
        assert all(confusable("sensor_lag", name) for name in found.verdict.names)
