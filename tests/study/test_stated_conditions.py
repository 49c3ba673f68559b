"""A load in the name of a group or sheet, in a title, or in a property is a condition of that run."""

import pytest

from extras import skip_without
from smarig.study import StudyOptions, study
from smarig.study.imported_runs import import_tables
from smarig.study.understanding import understand
from study.known_data import displacements, temperatures

U = temperatures(1, 150)
QUICK = StudyOptions(diagnose=False)


def tdms(tmp_path, groups):
    """A file of groups with their properties: the wire switches 0.5 K later for each group."""
    skip_without("nptdms", extra="tdms")
    from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

    objects = [RootObject(properties={"name": "rig"})]
    for k, (name, properties) in enumerate(groups.items()):
        objects.append(GroupObject(name, properties=properties))
        for channel, x, unit in (("Temp", U, "degC"), ("Stroke", displacements(U - 0.5 * k, seed=k), "mm")):
            entries = {"unit_string": unit, "wf_increment": 0.5}
            objects.append(ChannelObject(name, channel, x, properties=entries))
    path = tmp_path / "loads.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment(objects)
    return path


def workbook(tmp_path, sheets):
    """A book of sheets, each with its title."""
    skip_without("openpyxl", extra="files")
    import openpyxl

    book = openpyxl.Workbook()
    book.remove(book.active)
    for k, (name, title) in enumerate(sheets.items()):
        sheet = book.create_sheet(name)
        sheet.append([title] if title else ["Zyklus", str(k)])
        sheet.append(["Zeit [s]", "Temperatur [°C]", "Weg [mm]"])
        for t, (u, x) in enumerate(zip(U, displacements(U - 0.5 * k, seed=k))):
            sheet.append([float(t), round(u, 2), round(float(x), 4)])
    path = tmp_path / "wires.xlsx"
    book.save(path)
    return path


def conditions(path, tmp_path):
    tables, _ = import_tables(understand([path], QUICK).guesses, tmp_path / "out", None, "a")
    found = [table.run.info.conditions for table in tables]
    return [{name: (c["mean"], c["unit"]) for name, c in each.items()} for each in found]


@pytest.mark.parametrize(
    ("groups", "name", "unit"),
    [
        ({"Load 4 N": {}, "Load 12,5 N": {}}, "load", "N"),
        ({"run 1": {"Load_N": 4.0}, "run 2": {"Load_N": 12.5}}, "load", "N"),
        ({"run 1": {"Force": "4 N"}, "run 2": {"Force": "12.5 N"}}, "load", "N"),
        ({"4MPa": {}, "12.5MPa": {"Stress_limit": "900 MPa", "Sensor_N": 500.0}}, "stress", "MPa"),
    ],
)
def test_a_group_of_a_tdms_file(tmp_path, groups, name, unit):
    found = conditions(tdms(tmp_path, groups), tmp_path)
    assert found == [{name: (4.0, unit)}, {name: (12.5, unit)}]


@pytest.mark.parametrize(
    "sheets",
    [
        {"10N": "", "25N": ""},
        {"A": "Versuch Draht #7 - Gewicht 10 N", "B": "Versuch Draht #7 - Gewicht 25 N"},
        {"A": "wire 3, load = 10 N", "B": "wire 3 (force: 25 N)"},
    ],
)
def test_a_sheet_of_a_workbook(tmp_path, sheets):
    assert conditions(workbook(tmp_path, sheets), tmp_path) == [{"load": (10.0, "N")}, {"load": (25.0, "N")}]


@pytest.mark.parametrize("title", ["Kraftaufnehmer 500 N", "max. 500 N", "Wire 7", "Gewicht 12 mg", "Load 7"])
def test_other_titles_state_no_load(tmp_path, title):
    assert conditions(workbook(tmp_path, {"A": title}), tmp_path) == [{}]


def test_the_shift_per_load_follows_and_the_mapping_says_where_it_is_stated(tmp_path):
    path = tdms(tmp_path, {f"Load {load} N": {} for load in (5, 10, 15)})
    result = study([path], tmp_path / "out", QUICK)
    (shift,) = [s for s in result.transformation.load_slopes if s.temperature == "A_s"]
    assert shift.unit == "N"
    assert shift.K_per_unit == pytest.approx(0.1, abs=0.05)
    assert "# the name of the group 'Load 5 N'" in (tmp_path / "out" / "mapping.toml").read_text()


def test_a_force_that_is_measured_is_no_condition(tmp_path):
    path = tmp_path / "clamped.csv"
    rows = [f"{t},{u:.2f},{3 + x:.4f}" for t, (u, x) in enumerate(zip(U, displacements(U)))]
    path.write_text("\n".join(["Force: 3 N", "", "Time [s],Temperature [°C],Force [N]", *rows]) + "\n")
    assert conditions(path, tmp_path) == [{}]


GRAVITY = 9.80665


@pytest.mark.parametrize(
    ("sheets", "kilograms"),
    [
        ({"200 g": "", "1,25kg": ""}, [0.2, 1.25]),
        ({"A": "Messreihe mit 350 g", "B": "wire 7, hanging mass 0.7 kg"}, [0.35, 0.7]),
        ({"Run_80g": "", "Probe 2, 90 g": "Draht 3"}, [0.08, 0.09]),
    ],
)
def test_a_weight_in_the_name_or_title_of_a_sheet_is_its_load(tmp_path, sheets, kilograms):
    found = conditions(workbook(tmp_path, sheets), tmp_path)
    assert [unit for each in found for _, unit in each.values()] == ["N", "N"]
    assert [each["load"][0] for each in found] == pytest.approx([m * GRAVITY for m in kilograms])


def test_a_load_of_the_same_place_comes_before_a_weight(tmp_path):
    found = conditions(workbook(tmp_path, {"A": "300 g | Gewicht 3 N", "300 g": "Load = 4 N"}), tmp_path)
    assert found == [{"load": (3.0, "N")}, {"load": (4.0, "N")}]


@pytest.mark.parametrize(
    "title",
    ["sample mass 2 g", "Einwaage 5 g", "load cell 10 kg", "200 g und 500 g", "2 x 500 g", "1.2 g/m", "7 GB"],
)
def test_other_masses_are_no_load(tmp_path, title):
    assert conditions(workbook(tmp_path, {"A": title}), tmp_path) == [{}]


@pytest.mark.parametrize(
    ("output", "expected"), [("Stroke [mm]", {"load": (0.15 * GRAVITY, "N")}), ("Force [N]", {})]
)
def test_a_weight_in_the_name_of_a_file(tmp_path, output, expected):
    path = tmp_path / "wire4_150g.csv"
    rows = [f"{t},{u:.2f},{3 + x:.4f}" for t, (u, x) in enumerate(zip(U, displacements(U)))]
    path.write_text("\n".join([f"Time [s],Temperature [°C],{output}", *rows]) + "\n")
    assert conditions(path, tmp_path) == [
        {name: (pytest.approx(value), unit) for name, (value, unit) in expected.items()}
    ]


def test_the_mass_of_a_calorimeter_is_that_of_the_sample(tmp_path):
    path = tmp_path / "NiTi_0.02g.csv"
    rows = [f"{t},{u:.2f},{x:.4f}" for t, (u, x) in enumerate(zip(U, displacements(U)))]
    path.write_text("\n".join(["Time [s],Temperature [°C],Heat flow [mW]", *rows]) + "\n")
    assert conditions(path, tmp_path) == [{}]


def test_the_mapping_says_which_weight_is_the_load(tmp_path):
    study([workbook(tmp_path, {"500 g": ""})], tmp_path / "out", QUICK)
    text = (tmp_path / "out" / "mapping.toml").read_text(encoding="utf-8")
    assert "# 4.9 N, the weight of 500 g in the name of the sheet '500 g'" in text
