"""Blocks of a text whose clock or input goes on are one record; others stay apart."""

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import StudyOptions, guess_table, mapping_draft, study
from smarig.study.joined_blocks import joined_blocks
from smarig.study.understanding import understand
from study.known_data import displacements

MINUTES = 1 / 60
NAMES = "Time\tTemperature\tDisplacement\tForce\nmin\t°C\tmm\tN\n"


def ramps(count, rows=90, low=20.0, high=115.0):
    """Temperatures of ramps one after the other, the first one up."""
    up = np.linspace(low, high, rows)
    return [up if k % 2 == 0 else up[::-1] for k in range(count)]


def blocks(path, parts, *, restart=False, loads=None, title="[step]\nRamp - {}\n"):
    """An export with a block for each ramp; the clock goes on or restarts in each."""
    rows, t = displacements(np.concatenate(parts)), 0.0
    text, at = "Filename\tx.tri\nInstrument\tDMA\n", 0
    for k, u in enumerate(parts):
        t = 0.0 if restart else t
        text += "\n" + title.format(k + 1) + NAMES
        for value in u:
            load = (loads or [3.0] * len(parts))[k] + 1e-3 * (at % 2)
            text += f"{t:.4f}\t{value:.3f}\t{rows[at]:.4f}\t{load:.3f}\n"
            t, at = t + MINUTES, at + 1
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("count", [2, 3, 5])
@pytest.mark.parametrize("title", ["[step]\nTemperature Ramp - {}\n", "", "Segment {}\n"])
def test_steps_of_one_clock_are_one_record(tmp_path, count, title):
    parts = ramps(count)
    path = blocks(tmp_path / "a.txt", parts, title=title)
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    (table,) = result.tables
    assert table.title == "a"
    np.testing.assert_allclose(table.run["input"], np.concatenate(parts), atol=1e-3)
    np.testing.assert_allclose(np.diff(table.run["t_s"]), 1.0, atol=0.01)
    assert f"{count} tables with the same columns are read as one record." in table.warnings
    assert "A_s" in result.transformation.lines()[0]
    assert not any("only a heating branch" in line for line in result.transformation.lines())


def test_files_of_more_and_fewer_steps_have_one_layout(tmp_path):
    paths = [blocks(tmp_path / f"{n}.txt", ramps(n)) for n in (2, 4)]
    guesses = understand(paths, StudyOptions()).guesses
    assert guesses[0].table.layout == guesses[1].table.layout


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("title", ["", "Interval {}\n"])
def test_a_clock_that_restarts_goes_on_where_the_input_does(tmp_path, count, title):
    path = blocks(tmp_path / "a.txt", ramps(count), restart=True, title=title)
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    (table,) = result.tables
    np.testing.assert_allclose(table.run["input"], np.concatenate(ramps(count)), atol=1e-3)
    np.testing.assert_allclose(np.diff(table.run["t_s"]), 1.0, atol=0.01)
    assert not any("only a heating branch" in line for line in result.transformation.lines())


@pytest.mark.parametrize("turned", [False, True])
def test_a_clock_that_restarts_at_another_input_keeps_blocks_apart(tmp_path, turned):
    again = [part[::-1] if turned else part for part in ramps(1) * 3]
    path = blocks(tmp_path / "a.txt", again, restart=True)
    assert len(understand([path], StudyOptions()).guesses) == 3


def test_another_load_is_another_record(tmp_path):
    path = blocks(tmp_path / "a.txt", ramps(6), loads=[3.0, 3.0, 5.0, 5.0, 7.0, 7.0])
    guesses = understand([path], StudyOptions()).guesses
    assert [len(guess.table) for guess in guesses] == [180, 180, 180]
    for guess, rows in zip(guesses, (slice(0, 180), slice(180, 360), slice(360, 540))):
        draft = tmp_path / "m.toml"
        draft.write_text(mapping_draft(guess, "m"), encoding="utf-8")
        report = import_file(path, format="csv", out=tmp_path / "a.sqlite", mapping=str(draft), force=True)
        np.testing.assert_allclose(load_run(report.run)["input"], np.concatenate(ramps(6))[rows], atol=1e-3)


@pytest.mark.parametrize("loops", [False, True])
def test_without_a_clock_branches_that_go_on_are_one_record(tmp_path, loops):
    parts = ramps(4) if not loops else [np.concatenate(ramps(2)), np.concatenate(ramps(2))]
    y, at, text = displacements(np.concatenate(parts)), 0, ""
    for k, u in enumerate(parts):
        rows = "".join(f"{a:.3f}\t{b:.4f}\n" for a, b in zip(u, y[at : at + u.size]))
        text, at = f"{text}\nSegment {k + 1}\nTemperature\tDisplacement\n°C\tmm\n{rows}", at + u.size
    path = tmp_path / "a.txt"
    path.write_text(text, encoding="utf-8")
    assert len(find_tables(path)) == len(parts)
    assert len(understand([path], StudyOptions()).guesses) == (2 if loops else 1)


@pytest.mark.parametrize(("tables", "message"), [(4, "has 3 table.* joins 4"), (3, None)])
def test_a_mapping_that_joins_more_than_there_are_is_refused(tmp_path, tables, message):
    path, draft = blocks(tmp_path / "a.txt", ramps(3)), tmp_path / "m.toml"
    text = mapping_draft(understand([path], StudyOptions()).guesses[0], "m")
    draft.write_text(text.replace("tables = 0", f"tables = {tables}"), encoding="utf-8")
    if message is None:
        import_file(path, format="csv", out=tmp_path / "a.sqlite", mapping=str(draft))
        return
    with pytest.raises(DataError, match=message):
        import_file(path, format="csv", out=tmp_path / "a.sqlite", mapping=str(draft))


def test_a_title_repeated_with_its_header_begins_the_next_piece(tmp_path):
    """As rheometers write intervals: tabs on an empty line, thousands with a comma, words in some rows."""
    path, lines, t = tmp_path / "a.csv", ["Project:\tgel", ""], 0.0
    legs = [np.linspace(20, 95, 40), np.linspace(95, 20, 40), np.linspace(20, 60, 30)]
    for number, u in enumerate(legs, 1):
        lines += [f"Interval and data points:\t{number}\t{u.size}"]
        lines += [
            "Interval data:\tPoint No.\tTime\tInterval Time\tTemperature\tStorage Modulus\tNormal Force\tStatus"
        ]
        lines += ["\t" * 7, "\t\t[s]\t[s]\t[°C]\t[Pa]\t[N]\t"]
        for k, value in enumerate(u):
            modulus = 12500 / (1 + np.exp((value - (75 if u[-1] > u[0] else 45)) / 3)) + 3
            word = "slip" if number == 1 and k > 30 else ""
            noise = 0.01 * (-1) ** k * (1 + k % 3)
            lines += [f"\t{k + 1}\t{t:.1f}\t{15.0 * k:.1f}\t{value:.2f}\t{modulus:,.2f}\t{noise:.3f}\t{word}"]
            t += 15.0
        lines += ["", ""]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    (joined,) = joined_blocks(find_tables(path))
    assert len(joined) == 110
    guess = guess_table(joined)
    names = {role: guess.first(role).name for role in ("time", "input", "output")}
    assert names == {"time": "Time", "input": "Temperature", "output": "Storage Modulus"}
    assert guess.first("output").quantity == "modulus"
    assert guess.first("output").facts.high > 12000
