"""Of which runs an unknown start may be assumed: data of others with a measured input, which a current may be."""

from pathlib import Path

import numpy as np
import pytest

from smarig.measurement import may_assume_start, noise_at_start, starting_state
from smarig.record import Run
from smarig.record.schema import SAMPLE_COLUMNS


def run(source, quantity, unit, *, current, part_of=""):
    """A run of ten samples; ``current``: whether a current was recorded; ``part_of``: the record that was cut."""
    rows = np.arange(10.0)
    columns = {name: np.full(10, np.nan) for name in SAMPLE_COLUMNS} | {"input": rows, "position": rows}
    if current:
        columns["current_A"] = rows / 10
    imported = {"file": "a.csv", **({"part_of": part_of} if part_of else {})}
    meta = {
        "source": source,
        "imported": imported,
        "input": {"quantity": quantity, "unit": unit},
        "output": {"unit": "mm"},
    }
    return Run(Path("a.run.sqlite"), meta, columns, (), ())


@pytest.mark.parametrize(
    ("source", "quantity", "unit", "current", "may"),
    [
        ("import", "temperature", "degC", False, True),
        ("import", "current", "A", True, False),
        ("import", "wire temperature above ambient", "K", True, False),  # computed from the current
        ("rig", "current", "A", True, False),  # the rig records its state
    ],
)
def test_the_start_of_data_with_a_measured_input_may_be_assumed(source, quantity, unit, current, may):
    assert may_assume_start(run(source, quantity, unit, current=current)) is may


def test_so_may_that_of_a_part_of_a_record_that_a_current_drives():
    assert may_assume_start(run("import", "current", "A", current=True, part_of="whole"))
    assert not may_assume_start(run("import", "wire temperature", "K", current=True, part_of="whole"))


def test_a_noisy_current_that_begins_at_rest_is_at_its_end():
    noise = np.random.default_rng(5).normal(0, 2e-3, 400)
    u = 0.45 * (1 - np.cos(np.linspace(0, 6 * np.pi, 400))) + noise
    u[0] = 0.006  # not the lowest reading, and further from it than the tolerance
    one = run("import", "current", "A", current=True)
    one.columns.update({name: np.resize(x, 400) for name, x in one.columns.items()} | {"input": u})
    ends, known = (-0.005, 0.905), noise_at_start(one)
    assert starting_state(None, u, ends, may_assume=False).state is None
    assert starting_state(None, u, ends, may_assume=False, noise=known).state == "negative"
    assert starting_state(None, u + 0.3, ends, may_assume=False, noise=known).state is None
    assert noise_at_start(run("rig", "current", "A", current=True)) == 0
