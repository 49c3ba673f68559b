"""Text that states no encoding: Latin-1, that of Windows or Shift-JIS, by the bytes that occur in a text."""

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.exchange import find_tables
from smarig.exchange.text.eight_bit_text import eight_bit_text

U = np.round(60 - 55 * np.cos(np.linspace(0, 4 * np.pi, 160)), 2)
X = np.round(3 + 2 * np.tanh((U - np.where(np.gradient(U) > 0, 66, 54)) / 6), 3)


def rows(head):
    cells = [f"{5 * k},{u},{'-FFFFFFF' if k in (20, 90) else x}" for k, (u, x) in enumerate(zip(U, X))]
    return "\r\n".join([head, *cells]) + "\r\n"


@pytest.mark.parametrize(
    "head",
    ["Time(ms),V,μm", "時間(ms),電圧(V),変位(μm)", "Time(ms),センサ(V),ヘンイ(μm)", "Time(ms),T(℃),x(mm)"],
)
def test_japanese_text(tmp_path, head):
    path = tmp_path / "a.csv"
    path.write_bytes(rows(head).encode("cp932"))
    (table,) = find_tables(path)
    assert table.names == tuple(head.split(","))
    assert np.flatnonzero(np.isnan(table.columns[2].values)).tolist() == [20, 90]


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252"])
@pytest.mark.parametrize(
    "head", ["Zeit [s],Temperatur [°C],Weg [µm]", "Prüfzeit,Größe,Ångström", "temps,température,écart à 0"]
)
def test_western_text_is_unchanged(tmp_path, encoding, head):
    path = tmp_path / "a.csv"
    path.write_bytes(rows(head).encode(encoding))
    (table,) = find_tables(path)
    assert table.names == tuple(head.split(","))


@pytest.mark.parametrize(
    "text",
    [
        "5 – 6 µm",
        "the wire’s strain",
        "„Probe“ 7, Größe",
        "‘as received’ – 20 °C",
        "100 € … 5 ‰",
        "Œuvre à Ålesund’s",
    ],
)
def test_typographic_signs_of_windows(text):
    assert eight_bit_text(text.encode("cp1252")) == (text, "Windows-1252")


def test_bytes_of_no_encoding_stay_latin(tmp_path):
    assert eight_bit_text(b"a\x81\x20\xb5")[1] == "Latin-1"


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("name", ["x\x83\x81", "\x9d\x8d", "\N{REPLACEMENT CHARACTER}m"])
def test_a_name_that_cannot_be_typed_is_given_by_its_number(tmp_path, capsys, name):
    path = tmp_path / "a.csv"
    path.write_text(rows(f"time [s],a [V],{name}").replace("-FFFFFFF", "3"), encoding="utf-8", newline="")
    command = ["study", str(path), "--no-diagnosis", "-o", str(tmp_path / "out")]
    (table,) = find_tables(path)
    assert cli(command) == 2
    assert "(columns: 'time [s]', 'a [V]', 'column 3')" in capsys.readouterr().err
    assert cli([*command, "--output", "column 3", "--unit", "column 3=mm"]) == 0
    assert cli([*command, "--output", "column 4"]) == 2
    assert table.names[2] not in ("column 3", "")
