"""Mapping files: permitted entries, errors, and the imported columns."""

import numpy as np
import pytest

from smarig.config import shipped_names
from smarig.core.errors import ConfigError, DataError, UsageError
from smarig.exchange import import_file, load_mapping
from smarig.exchange.units.unit_conversion import convert

PLAIN = """
name = "plain"
summary = "A test."
source = "this test"
[columns]
temperature_degC = { column = "T", unit = "K" }
position = { column = "x", unit = "um", scale = 2.0, offset = 1000.0 }
[input]
channel = "temperature_degC"
quantity = "temperature"
unit = "degC"
[output]
quantity = "displacement"
unit = "mm"
"""
DATA = "T;x\n300;0\n310;500\n305;250\n"


@pytest.fixture
def mapped(write, imported):
    """Import text through a mapping given as text."""

    def do(data, mapping=PLAIN, **options):
        return imported(write(data), mapping=str(write(mapping, "map.toml")), **options)

    return do


@pytest.mark.parametrize("name", shipped_names("imports"))
def test_every_shipped_mapping_is_valid_and_named_after_its_file(name):
    mapping = load_mapping(name)
    assert mapping.name == name
    assert mapping.source


def test_columns_are_renamed_scaled_and_converted(mapped):
    run = mapped(DATA)
    np.testing.assert_allclose(run["temperature_degC"], [26.85, 36.85, 31.85])
    np.testing.assert_allclose(run["position"], [1.0, 2.0, 1.5])  # (2 x + 1000) um
    np.testing.assert_array_equal(run["input"], run["temperature_degC"])
    assert not run.has("t_s")
    assert run["tick"].tolist() == [0, 1, 2]
    assert run.meta["config"] == PLAIN


def test_branches_on_one_row_become_one_sequence(mapped):
    branches = """
[[branch]]
direction = "up"
columns = { current_A = { column = "ig", unit = "mA" }, position = { column = "xg", unit = "mm" } }
[[branch]]
direction = "down"
columns = { current_A = { column = "id", unit = "mA" }, position = { column = "xd", unit = "mm" } }
[input]
channel = "current_A"
quantity = "current"
unit = "A"
[output]"""
    mapping = PLAIN[: PLAIN.index("[columns]")] + 'steps = "rows"\n' + branches + PLAIN.split("[output]")[1]
    run = mapped("ig,xg,id,xd\n0,0,100,9\n50,2,50,7\n100,9,0,1\n", mapping)
    np.testing.assert_allclose(run["input"], [0, 0.05, 0.1, 0.1, 0.05, 0])
    assert run["position"].tolist() == [0, 2, 9, 9, 7, 1]
    assert [s.branch for s in run.steps] == ["up"] * 3 + ["down"] * 3
    assert {s.verdict for s in run.steps} == {"settled"}
    assert any("listed twice" in w for w in run.meta["warnings"])


CLOCKED = PLAIN + '[time]\ncolumn = "t"\nunit = "ms"\n'


def test_time_is_converted(mapped):
    run = mapped("t,T,x\n0,300,0\n500,301,1\n1500,302,2\n", CLOCKED)
    np.testing.assert_allclose(run["t_s"], [0, 0.5, 1.5])


def test_repeated_times_are_refused_averaged_or_kept_as_the_mapping_specifies(mapped):
    data = "t,T,x\n0,300,0\n500,301,100\n500,303,300\n1500,302,2\n"
    with pytest.raises(DataError, match="line 4: 't' repeats 0.5 s"):
        mapped(data, CLOCKED)
    mean = mapped(data, CLOCKED + 'repeated = "mean"\n')
    np.testing.assert_allclose(mean["input"], [26.85, 28.85, 28.85])
    np.testing.assert_allclose(mean["t_s"], [0, 0.5, 1.5])
    kept = mapped(data, CLOCKED + 'repeated = "keep_order"\n')
    np.testing.assert_allclose(kept["t_s"], [0, 0.5, 0.5, 1.5])


def test_a_period_makes_the_clock_and_is_reported_as_not_measured(mapped):
    run = mapped(DATA, PLAIN + "[time]\nperiod_s = 0.25\n")
    np.testing.assert_allclose(run["t_s"], [0, 0.25, 0.5])
    assert any("not measured" in w for w in run.meta["warnings"])


def test_rows_in_pairs(mapped):
    mapping = PLAIN + '[time]\ncolumn = "t"\nperiod_s = 0.1\nrows_per_period = 2\n'
    run = mapped("t,T,x\n0,300,0\n0.01,301,1\n0,302,2\n0.01,303,3\n", mapping)
    np.testing.assert_allclose(run["t_s"], [0, 0.01, 0.1, 0.11])
    with pytest.raises(DataError, match="outside the period of 0.1 s"):
        mapped("t,T,x\n0,300,0\n0.2,301,1\n0,302,2\n0.01,303,3\n", mapping)


def test_two_sensors_that_disagree_lose_the_rows(mapped):
    mapping = (
        PLAIN
        + '[[compare]]\ncolumns = ["T", "T2"]\nwithin = 5.0\nunit = "K"\nblames = ["temperature_degC"]\n'
    )
    rows = [f"{300 + k},{k},{300 + k + (40 if 3 <= k < 5 else 0.1)}" for k in range(12)]
    run = mapped("T,x,T2\n" + "\n".join(rows), mapping)
    assert np.isnan(run["input"]).nonzero()[0].tolist() == [3, 4]
    assert any("disagree by up to 40 K in 2 rows (lines 5–6)" in w for w in run.meta["warnings"])
    rows = [f"{300 + k},{k},{400 + k}" for k in range(12)]
    with pytest.raises(DataError, match="in 12 of 12 rows; one of the two sensors failed"):
        mapped("T,x,T2\n" + "\n".join(rows), mapping)


def test_conditions_are_described_not_stored(mapped):
    mapping = PLAIN + '[conditions]\nstress = { column = "s", unit = "MPa" }\n'
    run = mapped("T,x,s\n300,0,50\n310,1,60\n305,2,40\n", mapping)
    assert run.meta["conditions"]["stress"] == {"unit": "MPa", "mean": 50.0, "min": 40.0, "max": 60.0}
    assert any(w.startswith("stress was not constant") for w in run.meta["warnings"])


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('unit = "um"', 'unit = "mn"'), "columns.position.unit: unit 'mn' is unknown; did you mean"),
        (
            ('unit = "um"', 'unit = "degC"'),
            "'degC' is a unit of temperature, but a unit of length was expected",
        ),
        (("summary", "sumary"), "unknown key 'sumary'; did you mean summary"),
        (("offset = 1000.0", "ofset = 1000.0"), "unknown key 'columns.position.ofset'"),
        (("temperature_degC =", "temperature ="), "temperature"),
        (('channel = "temperature_degC"', 'channel = "current_A"'), r"no 'current_A', which \[input\] names"),
        (("[output]", "[outpt]"), "outpt"),
        (("[columns]", "[time]\nunit = 's'\n[columns]"), "give 'column' or 'period_s'"),
        (("scale = 2.0", "scale = nan"), "finite"),
        (('name = "plain"', "name = plain"), "not valid TOML"),
    ],
)
def test_a_wrong_mapping_is_refused_naming_its_key(mapped, change, said):
    with pytest.raises(ConfigError, match=said):
        mapped(DATA, PLAIN.replace(*change))


def _with_output_unit(column, output, first=""):
    return first + PLAIN.replace('unit = "um"', f'unit = "{column}"').replace(
        'unit = "mm"', f'unit = "{output}"'
    )


@pytest.mark.parametrize(
    ("column", "output", "stored", "factor"),
    [
        ("mA*h", "mAh", "mAh", 1.0),
        ("mA.h", "Ah", "Ah", 1e-3),
        ("kΩ", "ohm", "ohm", 1e3),
        ("bar", "kPa", "kPa", 100.0),
        ("mmol/g", "mol/kg", "mol/kg", 1.0),
        ("mC", "C", "C", 1e-3),
        ("beats", "beats", "beats", 1.0),  # unknown: a name
        ("cm³(STP)/g", "cm³(STP)/g", "cm³(STP)/g", 1.0),
    ],
)
def test_known_units_are_converted_and_unknown_ones_kept_as_names(mapped, column, output, stored, factor):
    run = mapped(DATA, _with_output_unit(column, output))
    assert run.unit == stored
    np.testing.assert_allclose(run["position"], np.array([1000.0, 2000.0, 1500.0]) * factor)


@pytest.mark.parametrize(("slip", "meant"), [("degc", "degC"), ("mmm", "mm"), ("mpa", "mPa")])
def test_a_unit_that_looks_like_a_slip_is_refused_unless_it_is_listed(mapped, slip, meant):
    with pytest.raises(ConfigError, match=f"'{slip}' is unknown; did you mean {meant}.*own_units"):
        mapped(DATA, _with_output_unit(slip, slip))
    assert mapped(DATA, _with_output_unit(slip, slip, f'own_units = ["{slip}"]')).unit == slip


def test_an_unknown_unit_is_not_converted(mapped):
    with pytest.raises(ConfigError, match="unit 'beats' is unknown and cannot be converted to 'mm'"):
        mapped(DATA, _with_output_unit("beats", "mm"))


def test_every_column_must_be_accounted_for(mapped):
    with pytest.raises(ConfigError, match="no column 'x', which mapping plain uses as position"):
        mapped("T;y\n1;2\n2;3\n")
    extra = "T;x;z\n300;1;2\n310;2;3\n"
    with pytest.raises(ConfigError, match=r"column 'z' is not in mapping plain\. Map it, or list it under"):
        mapped(extra)
    assert len(mapped(extra, PLAIN + '[ignore]\nz = "nobody knows"\n')) == 2


@pytest.mark.parametrize(
    ("mapping", "data", "said"),
    [
        (PLAIN, "T;x\n20;0\n-30;1\n", "line 3, column 'T': -303.15 degC as temperature_degC"),
        (
            PLAIN.replace("displacement", "strain").replace('"mm"', '"mm/mm"').replace('"um"', '"mm/mm"'),
            DATA,
            "in %",
        ),
    ],
)
def test_a_unit_that_makes_the_data_impossible_is_refused(mapped, mapping, data, said):
    with pytest.raises(DataError, match=said):
        mapped(data, mapping)


def test_an_unknown_mapping_is_refused_with_the_nearest_name(write, tmp_path):
    with pytest.raises(UsageError, match="did you mean sma_staircase"):
        import_file(write(DATA), format="csv", mapping="sma_stairs", out=tmp_path / "x")


def test_a_table_number_belongs_to_files_of_several_tables():
    assert load_mapping("ferroelectric_loops:4").file.table == 4
    with pytest.raises(UsageError, match="files of one table"):
        load_mapping("sma_staircase:2")
    with pytest.raises(UsageError, match=r"sma_staircase:9{20}"):
        load_mapping("sma_staircase:" + "9" * 5000)


@pytest.mark.parametrize(
    ("value", "unit", "to", "expected"),
    [
        (0.0, "K", "degC", -273.15),
        (212.0, "degF", "degC", 100.0),
        (1.0, "rad", "deg", 57.29577951308232),
        (1.0, "Oe", "A/m", 79.57747154594767),
        (2.5, "emu", "A m^2", 2.5e-3),
        (1.0, "uC/cm^2", "C/m^2", 0.01),
        (3.0, "%", "mm/mm", 0.03),
        (1.5, "h", "s", 5400.0),
    ],
)
def test_units(value, unit, to, expected):
    assert convert(value, unit, to) == pytest.approx(expected, rel=1e-9)
    assert convert(expected, to, unit) == pytest.approx(value, rel=1e-9, abs=1e-9)


def test_conditions_may_be_constants_and_texts(mapped):
    conditions = """
[conditions]
room_temperature = { value = 22.5, unit = "degC" }
specimen = { text = "A7" }
"""
    run = mapped(DATA, PLAIN + conditions)
    room = {"unit": "degC", "mean": 22.5, "min": 22.5, "max": 22.5}
    assert run.meta["conditions"] == {"room_temperature": room, "specimen": {"text": "A7"}}


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('stress = { value = 5.0, unit = "mm" }', "unit of stress or pressure was expected"),
        ('stress = { text = "high" }', "a number was expected"),
        ('stress = { value = 5.0, column = "x", unit = "MPa" }', "exactly one of column, value and text"),
        ("stress = { value = 5.0 }", "needs its unit"),
        ('frequency = { value = 5.0, unit = "s" }', "unit of frequency was expected"),
    ],
)
def test_a_condition_has_one_source_and_a_fitting_unit(mapped, line, message):
    with pytest.raises(ConfigError, match=message):
        mapped(DATA, PLAIN + "[conditions]\n" + line + "\n")


def test_an_arbitrary_zero_of_the_output_is_recorded(mapped):
    assert mapped(DATA).info.encoder_zero is None
    assert mapped(DATA, PLAIN + 'zero = "own"\n').info.encoder_zero == "own"
