"""Columns in pairs of a clock and a value: channels of several periods on one clock, with their names."""

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

END_MS = 60_000


def temperature(t_ms):
    return 60 - 35 * np.cos(4 * np.pi * t_ms / END_MS)


def stroke(t_ms):
    t = temperature(t_ms)
    return 2 * (1 + np.tanh((t - np.where(np.sin(4 * np.pi * t_ms / END_MS) > 0, 66, 52)) / 5))


def channels(periods=(200, 50), shift=0):
    """The times and the readings of temperature and stroke."""
    clocks = [np.arange(j * shift, END_MS + 1, period) for j, period in enumerate(periods)]
    return [(t, f(t)) for t, f in zip(clocks, (temperature, stroke))]


def rows(found, sign="\t", comma=True, stamp=str):
    """The lines of the pairs; the channels with fewer readings end early."""
    out = []
    for k in range(max(t.size for t, _ in found)):
        cells = [
            cell for t, x in found for cell in ((stamp(t[k]), f"{x[k]:.4f}") if k < t.size else ("", ""))
        ]
        out.append(sign.join(cells).replace(".", ",") if comma else sign.join(cells))
    return out


def scope(periods, key="SampleTime[ms]", factor=1):
    keys = {
        "Name": ("fTemp", "fPos"),
        "SymbolComment": ("Pt1000", "Weg"),
        key: tuple(f"{p * factor:g}" for p in periods),
    }
    keys |= {"Port": (851, 851), "Unit": ("°C", "mm"), "Unit Offset": (0, 0)}
    heading = ["\t".join(f"{key}\t{value}" for value in values) for key, values in keys.items()]
    text = ["Name\tYT Scope Project", "File\tC:\\SMA.svdx", "", *heading, "", *rows(channels(periods)), "EOF"]
    return "\n".join(text) + "\n"


def imported(path):
    (table,) = find_tables(path)
    guess, mapping = guess_table(table), path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format="csv", out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    return table, load_run(report.run), [finding.text for finding in report.findings]


def check(run, every_ms):
    both = np.isfinite(run["temperature_degC"]) & np.isfinite(run["position"])
    t_ms = np.round(1000 * run["t_s"][both])
    assert both.sum() == END_MS // every_ms + 1
    np.testing.assert_allclose(np.diff(t_ms), every_ms)
    np.testing.assert_allclose(run["temperature_degC"][both], temperature(t_ms), atol=1e-4)
    np.testing.assert_allclose(run["position"][both], stroke(t_ms), atol=1e-4)


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("periods", [(200, 50), (50, 50), (50, 500)])
@pytest.mark.parametrize(("key", "factor"), [("SampleTime[ms]", 1), ("Sample Time [s]", 1e-3)])
def test_keys_above_each_pair_name_it(write, periods, key, factor):
    table, run, findings = imported(write(scope(periods, key, factor)))
    assert table.names == ("time [ms]", "fTemp [°C]", "fPos [mm]")
    check(run, max(periods))
    (sentence,) = [text for text in findings if "each with its own clock" in text]
    assert f"fTemp [°C] ({END_MS // periods[0] + 1})" in sentence


def test_the_unit_of_a_clock_that_no_period_states_stays_open(write):
    assert find_tables(write(scope((50, 50), key="Cycle")))[0].names[0] == "time"


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("sign", [",", ";", "\t"])
@pytest.mark.parametrize(
    "names", [("Time [ms]", "Time [ms]"), ("Time_T [ms]", "Time_s [ms]"), ("t1 [ms]", "t2 [ms]")]
)
def test_a_row_of_names_over_pairs(write, sign, names):
    heading = sign.join((names[0], "T [°C]", names[1], "s [mm]"))
    text = "\n".join([heading, *rows(channels((250, 50)), sign, comma=sign == ";")]) + "\n"
    table, run, _ = imported(write(text))
    assert table.names == (names[1] if names[0] != names[1] else names[0], "T [°C]", "s [mm]")
    check(run, 250)


def test_stamps_of_each_channel(write):
    def stamp(t_ms):
        return f"2023-05-12 14:{int(t_ms) // 60000:02}:{int(t_ms) // 1000 % 60:02}.{int(t_ms) % 1000:03}"

    text = "\n".join(["Time,T [°C],Time,s [mm]", *rows(channels((500, 100)), ",", False, stamp)]) + "\n"
    check(imported(write(text))[1], 500)


def test_clocks_that_never_meet_are_joined_at_the_nearest_reading(write):
    found = channels((200, 200), shift=30)
    text = "\n".join(["Time [ms];T [°C];Time [ms];s [mm]", *rows(found, ";")]) + "\n"
    _, run, findings = imported(write(text))
    n = found[1][0].size
    np.testing.assert_allclose(run["position"][:n], found[1][1], atol=1e-4)
    np.testing.assert_allclose(1000 * run["t_s"], found[0][0])
    assert any("nothing is interpolated" in text for text in findings)


@pytest.mark.parametrize("heading", ["Time [ms];T [°C];Time [ms];s [mm]", "t;T;t;s"])
def test_one_clock_that_is_written_twice_is_left_alone(write, heading):
    text = "\n".join([heading, *rows(channels((50, 50)), ";")]) + "\n"
    assert len(find_tables(write(text))[0].columns) == 4


def test_pairs_without_clocks_are_left_alone(write):
    text = "\n".join(["T1 [°C];R1 [ohm];T2 [°C];R2 [ohm]", *rows(channels(), ";")]) + "\n"
    assert len(find_tables(write(text))[0].columns) == 4


@pytest.mark.parametrize(("names", "refused"), [(("Time", "time_2"), True), (("t", "t2"), False)])
def test_a_clock_that_goes_back_is_refused_where_its_name_is_that_of_a_time(write, names, refused):
    found = channels((200, 50))
    found[1][0][700:] -= 9000
    text = "\n".join([f"{names[0]};T [°C];{names[1]};s [mm]", *rows(found, ";")]) + "\n"
    if refused:
        with pytest.raises(DataError, match=r"that of 's \[mm\]' does not rise in line 702\."):
            find_tables(write(text))
    else:
        assert len(find_tables(write(text))[0].columns) == 4


def test_a_channel_of_one_reading(write):
    table = find_tables(write(scope((50, END_MS + 1))))[0]
    assert table.names == ("time", "fTemp [°C]", "fPos [mm]")
    assert [int(np.isfinite(c.values).sum()) for c in table.columns[1:]] == [END_MS // 50 + 1, 1]


def test_comments_above_pairs_belong_to_their_channels(write):
    table, _, _ = imported(write(scope((50, 50)).replace("SymbolComment", "Kommentar")))
    assert [column.comment for column in table.columns] == ["", "Pt1000", "Weg"]
