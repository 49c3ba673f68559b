"""Configuration files: all shipped files load, and every error names file, key and expected value in one
sentence."""

from pathlib import Path
from typing import get_args

import pytest

from smarig import config
from smarig.config import load_rig
from smarig.config.actuator_file import SurfaceName
from smarig.core import toml_file
from smarig.core.errors import ConfigError, UsageError
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_SURFACES

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
LOADERS = {"rigs": config.load_rig, "actuators": config.load_actuator, "campaigns": config.load_campaign}
SHIPPED = [(folder, path.stem) for folder in LOADERS for path in sorted((CONFIGS / folder).glob("*.toml"))]


@pytest.mark.parametrize(("folder", "name"), SHIPPED)
def test_what_ships_loads_under_its_file_name(folder: str, name: str):
    loaded = LOADERS[folder](name)
    assert loaded.name == name
    assert name in config.shipped_names(folder)
    assert LOADERS[folder](str(CONFIGS / folder / f"{name}.toml")) == loaded


def test_the_mark_that_an_editor_puts_before_a_file_is_no_part_of_it(tmp_path: Path):
    file = tmp_path / "marked.toml"
    file.write_text('base = "one_wire_twin"\nname = "marked"\n', encoding="utf-8-sig")
    assert load_rig(str(file)).name == "marked"
    assert not config.rig_text(str(file)).startswith("\ufeff")


def test_something_ships():
    assert {folder for folder, _ in SHIPPED} == set(LOADERS)


@pytest.mark.parametrize("name", config.shipped_names("rigs"))
def test_a_rig_names_an_actuator_that_ships(name: str):
    assert config.load_rig(name).actuator in config.shipped_names("actuators")


def test_loaded_values_are_frozen():
    rig = config.load_rig("one_wire_twin")
    with pytest.raises(ValueError, match="frozen"):
        rig.limits.current_max_A = 5.0


def test_a_quantity_is_its_number():
    assert float(config.load_actuator("gorbet_one_wire").wire.diameter) == 0.3


# --- mistakes: shipped file, what is replaced by what, the sentence --------------------------------------

RIG, WIRE, CAMPAIGN = ("rigs", "one_wire_twin"), ("actuators", "gorbet_one_wire"), ("campaigns", "quick_look")
MISTAKES = {
    "unknown key": (
        RIG,
        "period_s =",
        "perod_s = 0.1\nperiod_s =",
        r"unknown key 'perod_s'; did you mean period_s\? There are: ",
    ),
    "unknown key in a table": (
        RIG,
        "saturation_A = 1.0",
        "saturation_A = 1.0\nsaturation_mA = 1.0",
        r"unknown key 'amplifier.saturation_mA'; did you mean saturation_A\? There are: current_noise_A",
    ),
    "unknown key in a quantity": (
        WIRE,
        'diameter = { value = 0.3, unit = "mm"',
        'diameter = { value = 0.3, units = "mm"',
        r"unknown key 'wire.diameter.units'; did you mean unit\?",
    ),
    "a lease shorter than two ticks": (
        RIG,
        "lease_s = 1.0",
        "lease_s = 0.15",
        r"period_s = 0.1 is too long for lease_s = 0.15",
    ),
    "missing key": (RIG, "lease_s = 1.0", "", r"key 'lease_s' is missing\."),
    "missing limit": (RIG, "current_max_A = 1.0", "", r"key 'limits.current_max_A' is missing\."),
    "missing source": (
        WIRE,
        ', source = "section 5.1.3" }',
        " }",
        r"key 'heating.resistance_martensite.source' is missing\.",
    ),
    "wrong unit": (
        WIRE,
        'value = 0.3, unit = "mm"',
        'value = 300.0, unit = "um"',
        r"wire.diameter: unit is 'um', expected 'mm'",
    ),
    "negative quantity": (
        WIRE,
        "value = 840.0",
        "value = -840.0",
        "wire.specific_heat: value -840 must be positive",
    ),
    "zero quantity": (
        WIRE,
        "value = 4.5",
        "value = 0",
        "heating.resistance_austenite: value 0 must be positive",
    ),
    "infinite quantity": (WIRE, "value = 840.0", "value = inf", r"wire.specific_heat.value: .*finite"),
    "nan quantity": (WIRE, "value = 840.0", "value = nan", r"wire.specific_heat.value: .*finite"),
    "negative period": (
        RIG,
        "period_s = 0.1",
        "period_s = -0.1",
        r"period_s: Input should be greater than or equal to 0.001 \(given: -0\.1\)",
    ),
    "a word for a number": (
        RIG,
        "period_s = 0.1",
        'period_s = "fast"',
        r"period_s: .*number.* \(given: 'fast'\)",
    ),
    "limits without zero": (
        RIG,
        "current_min_A = 0.0",
        "current_min_A = 0.2",
        "limits: current_min_A ≤ 0 ≤ current_max_A is required, because zero current must always be allowed",
    ),
    "nan limit": (RIG, "current_max_A = 1.0", "current_max_A = nan", "limits"),
    "unknown kind": (
        RIG,
        'kind = "twin"',
        'kind = "tiwn"',
        r"kind: Input should be .*'twin'.* \(given: 'tiwn'\)",
    ),
    "unknown unit of position": (
        WIRE,
        'unit = "mm"\nradius',
        'unit = "inch"\nradius',
        "transmission.unit: Input should be 'mm' or 'deg'",
    ),
    "no steps": (CAMPAIGN, None, 'name = "x"\nsummary = "y"\nstep = []\n', "step: .*at least 1 entry"),
    "unknown purpose": (
        CAMPAIGN,
        'purpose = "prepare"',
        'purpose = "prepared"',
        r"step\.0\.purpose: .*'prepare'",
    ),
}


def written(tmp_path: Path, shipped: tuple[str, str], old: str | None, new: str) -> Path:
    text = (CONFIGS / shipped[0] / f"{shipped[1]}.toml").read_text(encoding="utf-8")
    assert old is None or old in text, "the shipped file has changed: this mistake no longer happens"
    path = tmp_path / "mine.toml"
    path.write_text(new if old is None else text.replace(old, new, 1), encoding="utf-8")
    return path


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_one_sentence(tmp_path, mistake: str):
    shipped, old, new, sentence = MISTAKES[mistake]
    path = written(tmp_path, shipped, old, new)
    with pytest.raises(ConfigError, match=sentence) as refusal:
        LOADERS[shipped[0]](str(path))
    lines = str(refusal.value).splitlines()
    assert all(line.startswith(f"{path}: ") for line in lines)
    assert refusal.value.exit_status == 2


def test_every_mistake_of_a_file_is_reported_at_once(tmp_path):
    path = written(tmp_path, RIG, "period_s = 0.1", "period = 0.1")
    with pytest.raises(ConfigError) as refusal:
        config.load_rig(str(path))
    told = str(refusal.value).splitlines()
    assert len(told) == 2
    assert "key 'period_s' is missing" in told[0]
    assert "unknown key 'period'; did you mean period_s?" in told[1]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"name = \n", r"mine\.toml is not valid TOML: .*line 1, column 8"),
        (b"name = 'a'\nname = 'b'\n", r"is not valid TOML: Cannot overwrite a value \(at line 2"),
        (b"name = '\xff'\n", "is not valid TOML: 'utf-8' codec"),
    ],
)
def test_bad_toml_names_the_line(tmp_path, content: bytes, sentence: str):
    path = tmp_path / "mine.toml"
    path.write_bytes(content)
    with pytest.raises(ConfigError, match=sentence):
        config.load_rig(str(path))


def test_missing_files_and_names():
    with pytest.raises(UsageError, match=r"There is no file nowhere/mine\.toml\."):
        config.load_rig("nowhere/mine.toml")
    with pytest.raises(UsageError, match=r"No rig 'one_wire_twn'; did you mean one_wire_twin\? There are: "):
        config.load_rig("one_wire_twn")
    with pytest.raises(UsageError, match=r"No actuator 'gorbet_two'; did you mean gorbet_two_wire\?"):
        config.load_actuator("gorbet_two")
    with pytest.raises(UsageError, match=r"No campaign 'xyzzy'\. There are: characterise, quick_look"):
        config.load_campaign("xyzzy")


def test_a_folder_is_no_configuration(tmp_path):
    folder = tmp_path / "mine.toml"
    folder.mkdir()
    for read in (config.load_rig, toml_file.read_toml):
        with pytest.raises(UsageError, match=r"mine\.toml is a folder\. Name a file in it\."):
            read(folder)


@pytest.mark.parametrize("value", ["inf", "nan", '"1.0"', "true"])
def test_a_limit_must_be_a_finite_number(tmp_path, value):
    text = config.locate("rigs", "one_wire_twin").read_text(encoding="utf-8")
    file = tmp_path / "rig.toml"
    file.write_text(
        text.replace("temperature_max_K = 185.0", f"temperature_max_K = {value}"), encoding="utf-8"
    )
    with pytest.raises(ConfigError, match=r"limits\.temperature_max_K"):
        config.load_rig(str(file))


def test_an_unknown_key_of_a_campaign_step_suggests_the_step_s_keys(tmp_path):
    file = tmp_path / "c.toml"
    file.write_text('name = "c"\nsummary = "s"\n[[step]]\nprotocl = "validation"\n', encoding="utf-8")
    with pytest.raises(ConfigError, match="did you mean protocol"):
        config.load_campaign(str(file))


def test_a_link_is_simulated_or_somewhere(tmp_path):
    path = tmp_path / "both.toml"
    both = 'name = "both"\nbase = "one_wire_serial"\nlinks.amplifier.url = "/dev/ttyUSB0"\n'
    path.write_text(both, encoding="utf-8")
    with pytest.raises(
        ConfigError, match=r"links.amplifier.url gives a device's address.* \[simulator\] starts"
    ):
        load_rig(str(path))
    path.write_text(both + "simulator.start = false\n", encoding="utf-8")
    assert load_rig(str(path)).links.amplifier.url == "/dev/ttyUSB0"


def actuator_with(tmp_path, old: str, new: str) -> str:
    path = tmp_path / "mine.toml"
    path.write_text((CONFIGS / "actuators/gorbet_one_wire.toml").read_text().replace(old, new))
    return str(path)


def test_an_unknown_surface_names_those_that_there_are(tmp_path):
    path = actuator_with(tmp_path, 'surface = "one_e"', 'surface = "zzz"')
    names = r"hysteresis\.surface.*'one_c', 'one_p', 'one_e', 'two_c', 'two_p' or 'two_e' \(given: 'zzz'\)"
    with pytest.raises(ConfigError, match=names):
        config.load_actuator(path)


def test_the_names_of_surfaces_are_those_of_the_table():
    assert get_args(SurfaceName) == THESIS_SURFACES


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ("[simulator]\ntrace = {}", "simulator.trace"),
        ("[simulator]\nfaults = {}", "simulator.faults"),
        ("[simulator]\nlibrary = {}", "simulator.library"),
        ("[simulator]\nmake = {}", "simulator.make"),
        ("[links.amplifier]\nurl = {}", "links.amplifier.url"),
        ("[links.amplifier]\ndriver = {}", "links.amplifier.driver"),
        ("[load]\nfile = {}", "load.file"),
        ("[load]\nformula = {}", "load.formula"),
    ],
)
@pytest.mark.parametrize("text", [r'"./a\u0000b.py"', r'"./a\u001b[2J.py"', r'"./a\nb.py"'])
def test_what_leads_out_of_a_rig_file_has_no_control_characters(tmp_path, table, key, text):
    path = tmp_path / "mine.toml"
    path.write_text(f'base = "one_wire_serial"\nname = "mine"\n{table.format(text)}\n')
    with pytest.raises(
        ConfigError, match=rf"{key}: a path, program or address has no control characters \(given: '.*'\)\.$"
    ):
        config.load_rig(str(path))


def test_neither_have_a_base_a_setting_or_a_protocol(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('base = "a\\u0000b"\n')
    with pytest.raises(ConfigError, match="key 'base' must name another rig file"):
        config.load_rig(str(path))
    path.write_text('base = "laboratory_supply"\n[links.amplifier.settings]\nmakes = ["a\\u0000b"]\n')
    with pytest.raises(ConfigError, match=r"links\.amplifier\.settings: a text has no null character\."):
        config.load_rig(str(path))
    for step in ('protocol = "./a\\u0000b.py"', 'protocol = "validation"\nset = { file = "a\\u0000b" }'):
        path.write_text(f'name = "mine"\nsummary = "x"\n[[step]]\n{step}\n')
        with pytest.raises(
            ConfigError, match=r"step\.0\.(protocol|set): .* no (control characters|null character)"
        ):
            config.load_campaign(str(path))


def test_a_bad_step_of_a_campaign_is_one_sentence_and_no_step_another(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('name = "mine"\nsummary = "x"\n[[step]]\nprotocol = "validation"\nname = "a/b"\n')
    with pytest.raises(ConfigError, match=r"^\S+: step\.0\.name: a name of a run .* \(given: 'a/b'\)\.$"):
        config.load_campaign(str(path))
    path.write_text('name = "mine"\nsummary = "x"\nstep = []\n')
    with pytest.raises(ConfigError, match=r"^\S+: step: it must have at least 1 entry \(given: "):
        config.load_campaign(str(path))
