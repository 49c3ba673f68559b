"""Logs of serial monitors and of keys and values are tables: stamps become a clock, keys become names."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarig.core import DataError
from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft
from smarig.study.data_files import find_files

ROWS = 60
U = np.round(60 - 35 * np.cos(np.linspace(0, 4 * np.pi, ROWS)), 2)
Y = np.round(np.tanh((U - 60) / 20), 3)
R = np.round(3 - 0.4 * Y, 4)
SIGNS = {"semicolon": ";", "comma": ",", "tab": "\t", "blank": " ", "blanks": "  "}


def stamp(seconds, form):
    whole = int(seconds) % 86400
    text = f"{whole // 3600:02d}:{whole // 60 % 60:02d}:{whole % 60:02d}.{round(1000 * (seconds % 1)):03d}"
    return {"arrow": f"{text} -> ", "brackets": f"[{text}] > ", "sign": f"{text} → "}[form]


def stamped(rows, start, form="arrow", period=0.5):
    return [stamp(start + period * k, form) + row for k, row in enumerate(rows)]


def read(path, tmp_path):
    """The guess of a file, and its run."""
    (table,) = find_tables(path)
    guess = guess_table(table)
    draft = tmp_path / "m.toml"
    draft.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format="csv", out=tmp_path / "a.run.sqlite", mapping=str(draft), force=True)
    return guess, load_run(report.run)


@settings(max_examples=25)
@given(
    sign=st.sampled_from(sorted(SIGNS)),
    form=st.sampled_from(["arrow", "brackets", "sign"]),
    start=st.sampled_from([0.0, 43200.25, 86390.5]),
    boot=st.booleans(),
    stamped_names=st.booleans(),
    end=st.sampled_from(["\n", "\r\n"]),
)
def test_stamps_are_a_clock_of_their_own(tmp_path_factory, sign, form, start, boot, stamped_names, end):
    folder = tmp_path_factory.mktemp("log")
    lines = [SIGNS[sign].join([f"{u:.2f}", f"{y:.3f}", f"{r:.4f}"]) for u, y, r in zip(U, Y, R)]
    names = SIGNS[sign].join(["T_wire", "pos_mm", "R_ohm"])
    lines = (
        stamped([names, *lines], start - 0.5, form)
        if stamped_names
        else [names, *stamped(lines, start, form)]
    )
    text = end.join([*(["SMA rig v3 starting..."] if boot else []), *lines]) + end
    (folder / "a.txt").write_bytes(text.encode())
    guess, run = read(folder / "a.txt", folder)
    assert guess.table.names == ("stamp", "T_wire", "pos_mm", "R_ohm")
    assert guess.first("time").name == "stamp"
    np.testing.assert_allclose(run["t_s"], 0.5 * np.arange(ROWS), atol=1e-9)  # over midnight, too
    np.testing.assert_array_equal(run["input"], U)
    np.testing.assert_array_equal(run["position"], Y)


@pytest.mark.parametrize("sign", sorted(SIGNS))
def test_stamped_rows_without_names_are_numbered(tmp_path, sign):
    rows = [SIGNS[sign].join([f"{u:.2f}", f"{y:.3f}"]) for u, y in zip(U, Y)]
    (tmp_path / "a.txt").write_text("\n".join(stamped(rows, 100.0)) + "\n")
    guess, run = read(tmp_path / "a.txt", tmp_path)
    assert guess.table.names == ("stamp", "column 1", "column 2")
    np.testing.assert_array_equal(run["input"], U)


FORMS = {
    "equals": ("{k}={v}", " "),
    "equals, comma": ("{k}={v}", ", "),
    "colon, comma": ("{k}:{v}", ","),
    "colon, tab": ("{k}: {v}", "\t"),
    "spaced": ("{k} = {v}", "; "),
}


@pytest.mark.parametrize("with_stamp", [False, True])
@pytest.mark.parametrize("form", FORMS)
def test_keys_are_the_names_of_the_columns(tmp_path, form, with_stamp):
    pair, between = FORMS[form]
    rows = [
        between.join(pair.format(k=k, v=v) for k, v in (("t", 0.5 * n), ("T", u), ("pos", y)))
        for n, (u, y) in enumerate(zip(U, Y))
    ]
    rows = stamped(rows, 43200.0, period=0.05) if with_stamp else rows
    (tmp_path / "a.log").write_text("Ready\n" + "\n".join(rows) + "\n")
    guess, run = read(tmp_path / "a.log", tmp_path)
    assert guess.table.names == (*(("stamp",) if with_stamp else ()), "t", "T", "pos")
    assert guess.first("input").name == "T"
    np.testing.assert_array_equal(run["input"], U)
    np.testing.assert_array_equal(run["position"], Y)
    assert any("the keys are the names" in w for w in run.info.warnings)


@pytest.mark.parametrize("with_stamp", [False, True])
@pytest.mark.parametrize(
    "start",
    [["Ready", ""], ["=~= PuTTY log 2024.05.02 =~=", "rst:0x1 (POWERON)", "", "# pot: 10 bit", "probes: 2"]]
    + [["calibrating ..."] * 270],
)
def test_what_is_logged_at_the_start_leaves_the_names(tmp_path, start, with_stamp):
    rows = [f"ms:{500 * n}\tT:{u}\tpot:{round(500 + 90 * y)}" for n, (u, y) in enumerate(zip(U, Y))]
    lines = stamped([*start, *rows], 3600.0) if with_stamp else [*start, *rows]
    (tmp_path / "a.log").write_text("\n".join(lines) + "\n")
    (table,) = find_tables(tmp_path / "a.log")
    assert table.names == (*(("stamp",) if with_stamp else ()), "ms", "T", "pot")
    assert len(table) == ROWS
    _, run = read(tmp_path / "a.log", tmp_path)
    np.testing.assert_array_equal(run["input"], U)
    lines[len(start) + 7] = lines[len(start) + 7].split("T:")[0] + "T:far\tpot:1"
    (tmp_path / "a.log").write_text("\n".join(lines) + "\n")
    mapping = str(tmp_path / "m.toml")
    with pytest.raises(DataError, match=rf"line {len(start) + 8}, column 'T': 'far' is not a number"):
        import_file(tmp_path / "a.log", format="csv", out=tmp_path / "b.run.sqlite", mapping=mapping)


def test_units_behind_the_values_and_a_key_that_is_missing_once(tmp_path):
    rows = [f"T={u}C pos={y}mm" if n != 7 else f"T={u}C other=1" for n, (u, y) in enumerate(zip(U, Y))]
    (tmp_path / "a.log").write_text("\n".join(rows) + "\n")
    (table,) = find_tables(tmp_path / "a.log")
    assert table.names == ("T [C]", "pos [mm]", "other")
    assert np.flatnonzero(np.isnan(table.columns[1].values)).tolist() == [7]


def test_errors_name_the_line_of_the_file(write, tmp_path):
    rows = [f"T={u} pos={y}" for u, y in zip(U, Y)]
    path = write("\n".join(rows) + "\n", "a.log")
    read(path, tmp_path)
    rows[20] = "T=far pos=1"
    path.write_text("\n".join(rows) + "\n")
    with pytest.raises(DataError, match=r"line 21, column 'T': 'far' is not a number"):
        import_file(
            path, format="csv", out=tmp_path / "b.run.sqlite", mapping=str(tmp_path / "m.toml"), force=True
        )


def test_prose_with_stamps_or_pairs_is_no_table(tmp_path):
    for text in ("12:00:00 -> Ready\n" * 9, "a=1 and b=2 are set\n" * 9, "Note: x=1\n" * 9):
        (tmp_path / "a.txt").write_text(text)
        with pytest.raises(DataError, match="holds no table"):
            find_tables(tmp_path / "a.txt")


def test_a_log_of_readings_in_a_folder_is_data_and_one_of_words_is_not(tmp_path):
    (tmp_path / "rig.log").write_text("\n".join(f"T={u} pos={y}" for u, y in zip(U, Y)) + "\n")
    (tmp_path / "server.log").write_text("12:00:00 started\n12:00:01 listening\n" * 5)
    found = find_files([tmp_path])
    assert [file.name for file in found.data] == ["rig.log"]


@pytest.mark.parametrize(
    ("name", "rows", "time"),
    [("serial_monitor_prefix/log.txt", 541, "stamp"), ("other_containers/arduino.log", 1200, "t")],
)
def test_the_given_logs(shared_data, tmp_path, name, rows, time):
    path = shared_data / "field_cases" / name
    if not path.is_file():
        pytest.skip(f"no {path.name} in {path.parent}")
    guess, run = read(path, tmp_path)
    assert (len(run), guess.first("time").name) == (rows, time)
    assert guess.first("input").quantity == "temperature"
    assert guess.first("output").name in ("pos_mm", "pos")
