"""Lines of comment that each begin with a key behind the sign: the key of the names is no part of a name."""

import numpy as np
import pytest

from smarig.exchange import find_tables

T = np.round(30 * np.sin(np.linspace(0, 12, 60)), 2)


def names_of(tmp_path, head):
    path = tmp_path / "scan.spec"
    rows = [f"{T[k]} {k} {np.tanh(T[k] / 9):.4f}" for k in range(60)]
    path.write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
    (table,) = find_tables(path)
    np.testing.assert_array_equal(table.columns[0].values, T)
    return table.names


@pytest.mark.parametrize("key", ["L", "K", "N1"])
@pytest.mark.parametrize("names", [("Field", "Epoch", "Strain"), ("Two Theta", "Epoch", "Det A")])
def test_the_key_is_no_part_of_a_name(tmp_path, key, names):
    assert names_of(tmp_path, ["#S 1  ascan", "#N 3", f"#{key} {'  '.join(names)}"]) == names


def test_a_letter_behind_the_sign_may_be_a_name(tmp_path):
    assert names_of(tmp_path, ["# made by hand", "#T n M"]) == ("T", "n", "M")
    assert names_of(tmp_path, ["#T n M"]) == ("T", "n", "M")
