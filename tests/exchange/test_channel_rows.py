"""Rows of one channel each: a column for each channel, or a refusal; never several channels in one column."""

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.exchange import find_tables, import_file
from smarig.exchange.layouts.channel_rows import channel_rows
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

SCANS = 150
U = np.round(60 - 35 * np.cos(np.linspace(0, 4 * np.pi, SCANS)), 3)
R = np.round(1.9 - 0.1 * np.tanh((U - np.where(np.gradient(U) > 0, 66, 54)) / 6), 5)
UNITS = {"101": "C", "102": "Ohm4W", "103": "Volt DC"}


def scanned(
    channels=("101", "102"), sign=",", lost=(), names="Index,Channel,Reading,Unit,Relative Time", by=0
):
    """A buffer of a scanning meter; ``by``: as many rows of a channel before those of the next, 0 for one."""
    rows = [
        (c, value, 2 * k + 0.25 * j)
        for k in range(SCANS)
        for j, (c, value) in enumerate(zip(channels, (U[k], R[k], 0.5 + 0.01 * k % 0.3)))
        if (k, c) not in lost
    ]
    rows = sorted(rows, key=lambda row: row[0]) if by else rows
    lines = ["Model,DAQ", 'Scan List,"101,102"', "", names.replace(",", sign)]
    lines += [
        sign.join((str(k + 1), c, f"{x:.8E}", UNITS[c], f"{t:.6f}")) for k, (c, x, t) in enumerate(rows)
    ]
    return "\n".join(lines) + "\n"


def imported(path):
    (table,) = find_tables(path)
    guess, mapping = guess_table(table), path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format="csv", out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    return guess, load_run(report.run), [finding.text for finding in report.findings]


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("sign", [",", ";", "\t"])
@pytest.mark.parametrize("channels", [("101", "102"), ("101", "102", "103")])
@pytest.mark.parametrize("end", ["\n", ""])
def test_each_channel_is_a_column(write, sign, channels, end):
    guess, run, findings = imported(write(scanned(channels, sign).removesuffix("\n") + end))
    drive, out = guess.first("input"), guess.first("output")
    assert (drive.name, drive.unit) == ("Reading 101 [C]", "degC")
    assert (out.name, out.unit) == ("Reading 102 [Ohm4W]", "ohm")
    np.testing.assert_allclose(run["temperature_degC"], U)
    np.testing.assert_allclose(run["position"], R)
    np.testing.assert_allclose(run["t_s"], 2.0 * np.arange(SCANS))
    (sentence,) = [text for text in findings if "by turns" in text]
    assert f"'Reading' holds {len(channels)} channels by turns" in sentence
    assert "the time of its first reading, that of 101" in sentence


@pytest.mark.parametrize("lost", [((40, "102"),), ((3, "102"), (77, "102"))])
def test_a_reading_that_is_missing_in_a_scan(write, lost):
    _, run, _ = imported(write(scanned(lost=lost)))
    np.testing.assert_allclose(run["temperature_degC"], U)
    assert np.flatnonzero(np.isnan(run["position"])).tolist() == [k for k, _ in lost]


def test_each_scan_keeps_the_line_of_its_first_reading():
    lines = scanned(("101", "102", "103")).splitlines()
    wide = channel_rows(lines).lines
    for k in range(0, SCANS, 7):
        assert wide[4 + 3 * k].split(",")[0] == lines[4 + 3 * k].split(",")[0]
        assert wide[5 + 3 * k] == ""


def test_channels_one_after_the_other_are_joined_on_time(write):
    _, run, findings = imported(write(scanned(by=1)))
    np.testing.assert_allclose(run["temperature_degC"], U)
    np.testing.assert_allclose(run["position"], R)
    assert any("nothing is interpolated" in text for text in findings)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (
            scanned(by=1, names="Index,Channel,Reading,Unit,Lap"),
            "is in long format: 'Reading' holds the readings",
        ),
        (scanned(names="Index,Channel,x,Unit,Relative Time"), "'Channel' has the channels '101', '102'"),
    ],
)
def test_what_cannot_be_told_apart_by_turns_is_refused(write, tmp_path, capsys, text, what):
    assert cli(["study", str(write(text)), "-o", str(tmp_path / "out")]) == 4
    printed = capsys.readouterr().err
    assert what in printed
    assert "Write one column for each" in printed


@pytest.mark.parametrize("column", [np.round(U), np.arange(SCANS) // 50, np.ones(SCANS)])
def test_a_column_that_is_only_named_so_is_left_alone(write, column):
    rows = [f"{k},{c:g},{u},{r}" for k, (c, u, r) in enumerate(zip(column, U, R))]
    (table,) = find_tables(write("\n".join(["time_s,CH,T_degC,R_ohm", *rows]) + "\n"))
    assert table.names == ("time_s", "CH", "T_degC", "R_ohm")
