"""Names and units of columns are found whatever sign divides them, and however that sign differs from the numbers'."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarig.exchange import find_tables
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import TableLayout

SIGNS = {"blank": " ", "two blanks": "  ", "tab": "\t", "semicolon": ";", "comma": ",", "bar": " | "}
ROW_SIGNS = ("\t", ";", ",", "  ", " ")
PLAIN = ("Temperature", "Strain", "Stress", "Time", "Resistance", "Weg", "ε", "x1")
VALUES = np.round(np.random.default_rng(3).normal(20, 5, (12, len(PLAIN))), 3)


def written(names, sign, row_sign, *, units=(), comment="", before=()):
    rows = [row_sign.join(f"{x:.3f}" for x in row[: len(names)]) for row in VALUES]
    head = [comment + sign.join(names)] + ([comment + sign.join(units)] if units else [])
    return "\n".join([*before, *head, *rows]) + "\n"


@settings(max_examples=40)
@given(
    names=st.lists(st.sampled_from(PLAIN), min_size=2, max_size=6, unique=True),
    sign=st.sampled_from(sorted(SIGNS)),
    row_sign=st.sampled_from(ROW_SIGNS),
    with_units=st.booleans(),
    comment=st.sampled_from(["", "# ", "%"]),
    before=st.sampled_from([(), ("",), ("Specimen: A 7 of batch 3, annealed at 450",)]),
)
def test_as_many_words_as_columns_are_their_names(
    tmp_path_factory, names, sign, row_sign, with_units, comment, before
):
    units = ["degC", "%", "MPa", "s", "ohm", "mm"][: len(names)] if with_units else []
    path = tmp_path_factory.mktemp("signs") / "a.txt"
    text = written(names, SIGNS[sign], row_sign, units=units, comment=comment, before=before)
    path.write_text(text, encoding="utf-8")
    (table,) = find_tables(path)
    assert table.names == tuple(names)
    assert [column.unit for column in table.columns] == (units or [""] * len(names))
    again = read_table(path, TableLayout(**({"known": table.names} | table.layout["file"])))
    for k, name in enumerate(names):
        np.testing.assert_array_equal(again.columns[name], VALUES[:, k])


@pytest.mark.parametrize(
    ("head", "names"),
    [
        ("T [degC] Strain [%]", ("T [degC]", "Strain [%]")),
        ("Wire temperature; Strain", ("Wire temperature", "Strain")),
        ("Wire temperature\tStrain of gauge", ("Wire temperature", "Strain of gauge")),
        ("Temperature Strain Stress", None),  # three words, two columns
        ("Run 7", None),  # a number is no name
        ("same same", None),
    ],
)
def test_only_that_many_words_and_no_number(tmp_path, head, names):
    for row_sign in ("\t", "  ") if names else ("\t",):
        path = tmp_path / "a.txt"
        path.write_text(head + "\n" + "\n".join(row_sign.join(map(str, row[:2])) for row in VALUES) + "\n")
        (table,) = find_tables(path)
        assert table.names == (names or ("column 1", "column 2"))


def test_a_title_of_as_many_words_further_up_is_no_header(tmp_path):
    path = tmp_path / "a.txt"
    rows = "\n".join("\t".join(map(str, row[:2])) for row in VALUES)
    path.write_text(f"Isobaric heating\nTemperature Strain\n{rows}\n")
    (table,) = find_tables(path)
    assert table.names == ("Temperature", "Strain")
    path.write_text(f"Isobaric heating\nof the first wire of batch\n{rows}\n")
    (table,) = find_tables(path)
    assert table.names == ("column 1", "column 2")
