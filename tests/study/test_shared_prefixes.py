"""A prefix that all names share says nothing of a column; an encoder that passes its ends is continued."""

import numpy as np
import pytest

from smarig.exchange.checks.wrapped_counts import continued_counts
from smarig.study import StudyOptions, study
from smarig.study.shared_prefixes import shared_prefix
from smarig.study.table_guess import guess_table
from study.known_data import displacements, table_of, temperatures

U = temperatures(3, 150)
COUNTS = np.round(300 * displacements(U, noise=0.002))


def columns(prefix, counts, rows=None):
    """As rostopic echo -p writes them."""
    n = np.arange(U.size) if rows is None else rows
    t = 1.683893e18 + 2e8 * n
    fields = {
        "header.seq": 1000 + n,
        "header.stamp": t - 1e6,
        "encoder": counts,
        "temp_c": U,
        "status": 0 * U,
    }
    return {"time": t} | {f"{prefix}{name}": x for name, x in fields.items()}


@pytest.mark.parametrize("prefix", ["field.", "feld/", "PLC1.current:", "msg.force."])
def test_a_shared_prefix_says_nothing_of_a_column_and_is_shown(prefix):
    guess = guess_table(table_of(**columns(prefix, COUNTS)))
    drive, out = guess.first("input"), guess.first("output")
    assert (drive.name, drive.quantity) == (f"{prefix}temp_c", "temperature")
    assert (out.name, out.quantity, out.unit) == (f"{prefix}encoder", "displacement", "count")
    assert guess.doubts == []


def test_a_sequence_with_gaps_and_its_stamps_are_no_outputs():
    rows = np.cumsum(1 + (np.arange(U.size) % 7 == 3))
    table = table_of(**columns("field.", COUNTS, rows))
    guess = guess_table(table, input="field.temp_c")
    assert guess.first("output").name == "field.encoder"
    quantities = {c.name: c.quantity for c in guess.columns}
    assert quantities["field.header.seq"] == "row number"
    assert quantities["field.header.stamp"] == "time"


@pytest.mark.parametrize(
    ("names", "prefix"),
    [
        (["a.b.temp", "a.b.pos", "a.c.force", "a.c.time"], "a."),
        (["t", "rig/temp", "rig/pos", "rig/force"], "rig/"),
        (["t", "u", "rig/temp", "rig/pos"], ""),
        (["Temp wire", "Temp oven", "Weg"], ""),
        (["field.1", "field.2", "field.3"], ""),
    ],
)
def test_prefixes(names, prefix):
    assert shared_prefix(names) == prefix


@pytest.mark.parametrize(
    ("bits", "start", "sense"),
    [(12, 3600, 1), (12, 300, -1), (10, 700, 1), (10, 700, -1), (16, 65_000, 1), (16, 500, -1)],
)
def test_a_position_that_passes_the_ends_of_its_register_is_continued(bits, start, sense):
    true = start + sense * COUNTS
    wrapped = true % 2**bits
    found = continued_counts(wrapped)
    assert (wrapped != true).any()
    np.testing.assert_allclose(np.diff(found), np.diff(true))


def test_counts_that_do_not_wrap_are_kept():
    duty = np.where(np.arange(400) % 40 < 20, 0.0, 255.0)
    rng = np.random.default_rng(2)
    for x in (COUNTS, COUNTS + 0.5, duty, rng.integers(0, 4096, 300).astype(float), np.r_[COUNTS, -3.0]):
        assert continued_counts(x) is x


def test_the_run_is_continued_and_its_remarks_say_so(tmp_path):
    path = tmp_path / "state.csv"
    data = columns("field.", (3600 + COUNTS) % 4096)
    rows = (
        ",".join(f"{x:.0f}" if x > 1e5 or x == round(x) else f"{x:.2f}" for x in row)
        for row in zip(*data.values())
    )
    path.write_text("\n".join([",".join(data).replace("time,", "%time,", 1), *rows]) + "\n")
    (table,) = study([path], tmp_path / "out", StudyOptions(diagnose=False)).tables
    np.testing.assert_allclose(np.ptp(table.run["position"]), np.ptp(COUNTS))
    assert any("'field.encoder' counts from 0 to 4095 and begins again" in text for text in table.warnings)
    assert any("It is continued there." in text for text in table.warnings)
