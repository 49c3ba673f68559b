"""Logs of a microcontroller without names: start-up lines name no columns, messages end no table, counters go on."""

import numpy as np
import pytest

from smarig.exchange import find_tables, import_file
from smarig.exchange.checks.time_axis import unwrapped
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

ROWS = 150
U = np.round(500 - 300 * np.cos(np.linspace(0, 4 * np.pi, ROWS)))
X = np.round(400 + 90 * np.tanh((U - np.where(np.gradient(U) > 0, 560, 440)) / 60))


def log(start, step, top, *, bits=32, message="heap: low", at=70, sign=","):
    """Rows of a counter and two channels, with a message between them."""
    stamps = (2**bits - top + step * np.arange(ROWS)) % 2**bits
    rows = [sign.join(f"{x:.0f}" for x in row) for row in zip(stamps, U, X)]
    return "\n".join([*start, *rows[:at], *([message] if message else []), *rows[at:]]) + "\n"


START = {
    "two fields": ["boot v2,mode: normal", "ready"],
    "two fields, two lines": ["chip:A7 rev 3,flash ok", "wifi off", "start"],
    "one field": ["ready"],
    "none": [],
}


@pytest.mark.parametrize("start", START.values(), ids=START)
@pytest.mark.parametrize("message", ["", "heap: low", "brown-out reset ignored"])
def test_start_lines_and_messages_are_no_names_and_no_end(write, start, message):
    (table,) = find_tables(write(log(start, 50, 1e9, message=message)))
    assert table.names == ("column 1", "column 2", "column 3")
    assert len(table) == ROWS
    np.testing.assert_array_equal(table.columns[1].values, U)


@pytest.mark.parametrize(("bits", "step", "top"), [(32, 100, 6000), (32, 20, 25), (16, 100, 9990)])
def test_a_counter_that_wraps_is_one_clock(write, bits, step, top):
    path = write(log(["ready"], step, top, bits=bits))
    (table,) = find_tables(path)
    guess = guess_table(
        table,
        input="column 2",
        output="column 3",
        units={"column 1": "ms", "column 2": "V", "column 3": "mm"},
    )
    assert guess.first("time").name == "column 1"
    mapping = path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format=table.format, out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    np.testing.assert_allclose(np.diff(load_run(report.run)["t_s"]), step * 1e-3, rtol=1e-6)
    assert any("'column 1' is a counter that began again from 0" in f.text for f in report.findings)


@pytest.mark.parametrize(
    "x",
    [
        np.r_[np.arange(60), np.arange(60)],  # a clock that was reset
        np.r_[np.arange(60000, 65000, 200), np.arange(0, 900, 200)],  # and one near its highest value
        U,
        np.arange(60.0),
        np.r_[-5.0, 0, 5, -65526],
    ],
)
def test_other_columns_are_as_they_are(x):
    np.testing.assert_array_equal(unwrapped(np.asarray(x, dtype=float)), x)


@pytest.mark.parametrize("cut", ["", "30500;41\n"])
def test_a_board_that_starts_again_writes_its_messages_again(tmp_path, cut):
    start = "Muscle bench 2.1\nADS1115 found\nmillis;T_wire;x_mm\n"
    rows = "".join(f"{500 + 250 * k};{30 + k % 40};{1.5 + 0.01 * k:.2f}\n" for k in range(120))
    path = tmp_path / "serial.txt"
    path.write_text(start + rows + cut + start + rows)
    (table,) = find_tables(path)
    assert table.names == ("millis", "T_wire", "x_mm")
    assert len(table) == 240 + bool(cut)
    assert table.layout["file"]["interruptions"] == "leave out"
