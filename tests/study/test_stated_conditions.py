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
