"""The table [thermomechanical]: every number with a source and unit, and a phase diagram that the model can follow."""

import pytest

from smarig.config import ThermomechanicalSection, actuator_text, load_actuator, shipped_names
from smarig.core.errors import ConfigError

NAMES = [n for n in shipped_names("actuators") if load_actuator(n).thermomechanical is not None]
ONE, TWO = "thermomechanical_one_wire", "thermomechanical_two_wire"
MISTAKES = {
    "unknown key": (ONE, "force = {", "forse = {", r"unknown key 'thermomechanical.forse'; did you mean force\?"),
    "missing constant": (ONE, "latent_heat = {", "# latent_heat = {", r"key 'thermomechanical.latent_heat' is missing"),
    "wrong unit": (ONE, 'unit = "degC"', 'unit = "K"', r"unit is 'K', expected 'degC'"),
    "no source": (ONE, 'unit = "N", source = "thesis section 5.1.1: 2 kg, about 277 MPa"', 'unit = "N"', "source"),
    "enormous latent heat": (ONE, "value = 24200.0", "value = 1e12", "latent_heat: value 1e.12 must lie between 0 and"),
    "strain of another unit": (TWO, "pre_strain = { value = 0.03", "pre_strain = { value = 3.0", "pre_strain: value 3"),
    "diameter in metres": (ONE, "diameter = { value = 0.3", "diameter = { value = 0.3e-9", "diameter: value 3e-10"),
    "negative latent heat": (ONE, "value = 24200.0", "value = -1.0", "latent_heat: value -1 must not be negative"),
    "zero slope": (ONE, "slope_austenite = { value = 8.0", "slope_austenite = { value = 0.0", "must be positive"),
    "finish above start": (ONE, "value = 60.0", "value = 30.0", "austenite_start must be smaller than"),
    "strips that overlap": (ONE, "value = 33.0", "value = 20.0", "at 0 MPa austenite forms from 20.0 degC on"),
    "strips that cross": (
        ONE,
        "slope_austenite = { value = 8.0",
        "slope_austenite = { value = 14.0",
        "at 1000 MPa austenite forms from 104.4 degC on, where martensite forms below 145.8 degC",
    ),
    "no weight": (ONE, "force = {", "pre_strain = {", "unit is 'N', expected '1'"),
    "no load": (ONE, "force = {", "# force = {", "one wire need thermomechanical.force"),
    "weight on two wires": (TWO, "pre_strain = {", "# pre_strain = {", "two wires need thermomechanical.pre_strain"),
    "unknown heat loss": (ONE, '"free_convection"', '"radiation"', "heat_loss: Input should be 'free_convection'"),
    "unit of position": (ONE, 'unit = "mm"\nradius', 'unit = "deg"\nradius', "its position in mm"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_one_sentence(tmp_path, mistake):
    name, old, new, sentence = MISTAKES[mistake]
    text = actuator_text(name)
    assert old in text, "the shipped file has changed"
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ConfigError, match=sentence) as refusal:
        load_actuator(str(path))
    assert all(line.startswith(f"{path}: ") for line in str(refusal.value).splitlines())


def test_four_wires_ship():
    assert NAMES == ["flexinol_015", "flexinol_031", ONE, TWO]


@pytest.mark.parametrize("name", NAMES)
def test_every_number_has_a_source(name):
    table = load_actuator(name).thermomechanical
    assert isinstance(table, ThermomechanicalSection)
    sources = [getattr(q, "source", "-") for q in dict(table).values() if q is not None]
    assert all(sources)
    assert len(sources) > 20
