"""A unit of the input or the output that nobody states is said to be assumed, with the usual ones of its quantity."""

import shlex

import numpy as np
import pytest

from smarig.study import StudyOptions, study
from study.known_data import displacements, temperatures

U = temperatures(2, 120)
Y = displacements(U)
COLUMNS = {
    "Voltage chan 1": U,
    "Current": U / 100,
    "T [°C]": U,
    "Position axis 1": Y,
    "Kraft": 5 + Y,
    "x [mm]": Y,
}


def studied(tmp_path, drive, out, **options):
    path = tmp_path / "loop.csv"
    rows = [f"{t},{u:.4f},{y:.5f}" for t, u, y in zip(np.arange(U.size), COLUMNS[drive], COLUMNS[out])]
    path.write_text("\n".join([f"t [s],{drive},{out}", *rows]) + "\n")
    given = StudyOptions(diagnose=False, input=drive, output=out, **options)
    return study([path], tmp_path / "out", given)


def units_in(sentence, name):
    """The units of a column in the commands of a sentence."""
    words = shlex.split(sentence)
    return [
        w.removeprefix(f"{name}=") for a, w in zip(words, words[1:]) if a == "--unit" and w.startswith(name)
    ]


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize(
    ("drive", "out", "assumed"),
    [
        ("Voltage chan 1", "x [mm]", {"Voltage chan 1": ("V", ["mV"])}),
        ("T [°C]", "Position axis 1", {"Position axis 1": ("mm", ["m", "um", "%", "V"])}),
        ("T [°C]", "Kraft", {"Kraft": ("N", ["mN", "kN"])}),
        (
            "Current",
            "Position axis 1",
            {"Current": ("A", ["mA"]), "Position axis 1": ("mm", ["m", "um", "%", "V"])},
        ),
        ("T [°C]", "x [mm]", {}),
    ],
)
def test_each_unit_that_is_assumed_is_said(tmp_path, drive, out, assumed):
    said = studied(tmp_path, drive, out).assumed
    assert said.count("The file states no unit of") == len(assumed)
    for name, (unit, others) in assumed.items():
        assert (
            f"The file states no unit of '{name}': {unit} is assumed. If it is another, name it: smarig study"
            in said
        )
        assert units_in(said, name) == others


def test_a_unit_that_is_given_is_not_assumed(tmp_path):
    given = {"Position axis 1": "um"}
    assert studied(tmp_path, "T [°C]", "Position axis 1", units=given).assumed == ""
