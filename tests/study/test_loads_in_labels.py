"""Runs side by side whose labels are values with units: the labels are whole, and they are conditions of the runs."""

import numpy as np
import pytest

from smarig.exchange import labelled_blocks
from smarig.study.imported_runs import import_tables
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand
from study.known_data import displacements, temperatures

NAMES = ["Clock (s)", "Temp (°C)", "Stroke (mm)"]


@pytest.mark.parametrize(
    "pattern", ["{name} {label}", "{label} {name}", "{label}: {name}", "{name} ({label})"]
)
@pytest.mark.parametrize(
    "labels", [["100 N", "150 N"], ["50 MPa", "150 MPa"], ["0.5 kg", "1.5 kg"], ["250g", "1kg"]]
)
def test_a_label_holds_whole_numbers_and_their_unit(pattern, labels):
    blocks = labelled_blocks([pattern.format(name=name, label=label) for label in labels for name in NAMES])
    assert [(block.label, list(block.names)) for block in blocks] == [(label, NAMES) for label in labels]


def test_a_label_holds_whole_words():
    blocks = labelled_blocks([f"{name} {way}" for way in ("soaking", "sinking") for name in NAMES])
    assert [(block.label, list(block.names)) for block in blocks] == [("soaking", NAMES), ("sinking", NAMES)]
    blocks = labelled_blocks([f"{name}{number}" for number in (10, 12) for name in "tTx"])
    assert [(block.label, block.names) for block in blocks] == [(n, tuple("tTx")) for n in ("10", "12")]


def test_a_name_is_not_taken_for_the_unit_of_a_label():
    names = ["T", "T set", "T bath"]
    blocks = labelled_blocks([f"Run {k} {name}" for k in (1, 2) for name in names])
    assert [(block.label, list(block.names)) for block in blocks] == [("Run 1", names), ("Run 2", names)]


@pytest.mark.parametrize(
    ("labels", "name", "values", "unit"),
    [
        (("150 g", "350 g"), "load", (1.471, 3.432), "N"),
        (("120 MPa", "180 MPa"), "stress", (120, 180), "MPa"),
        (("20 N", "35 N"), "load", (20, 35), "N"),
        (("100 Oe", "250 Oe"), "magnetic_field", (100, 250), "Oe"),
    ],
)
def test_a_label_that_is_a_value_is_the_condition_of_its_run(tmp_path, labels, name, values, unit):
    u = temperatures(2, 140)
    columns = [
        (2.0 * np.arange(u.size), u + k, displacements(u - 8 * k, seed=k)) for k, _ in enumerate(labels)
    ]
    names = [f"{label} {name}" for label in labels for name in NAMES]
    rows = [";".join(f"{x[k]:.4f}" for block in columns for x in block) for k in range(u.size)]
    path = tmp_path / "pulls.csv"
    path.write_text("\n".join([";".join(names), *rows]) + "\n", encoding="utf-8")
    found = understand([path], StudyOptions(accept=True))
    tables, left_out = import_tables(found.guesses, tmp_path / "out", None, "pulls")
    assert not left_out
    stated = [table.run.info.conditions[name] for table in tables]
    assert [entry["unit"] for entry in stated] == [unit, unit]
    assert [entry["mean"] for entry in stated] == pytest.approx(values, rel=1e-3)
