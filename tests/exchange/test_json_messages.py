"""Lines of messages end in an object of JSON: the time before it is a column, and one topic is the table."""

import json

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.exchange.layouts.json_lines import json_lines

U = np.round(25 + 40 * (1 - np.cos(np.linspace(0, 6, 30))), 2)


def messages(form, every=7):
    """A reading every 1.5 s, and the state of the device after some of them."""
    lines = []
    for k, u in enumerate(U.tolist()):
        hour = f"09:{20 + 3 * k // 120:02d}:{1.5 * k % 60:04.1f}"
        clock = form.format(hour=hour, day="2021-11-03", s=1.6e9 + 1.5 * k)
        lines.append(f"{clock}plant/rig2/readings {json.dumps({'wire_degC': u, 'gap_mm': round(u / 50, 3)})}")
        if k % every == 0:
            lines.append(f"{clock}plant/rig2/state {json.dumps({'mode': 'auto', 'load': 0.4 + k, 'up': k})}")
    return lines


@pytest.mark.parametrize(
    "form", ["{day}T{hour}+0100 ", "{day} {hour} ", "[{hour}] ", "{s:.1f} ", "{day}T{hour}Z: "]
)
@pytest.mark.parametrize("every", [1, 7])
def test_the_topic_with_most_readings_is_the_table(tmp_path, form, every):
    path = tmp_path / "messages.log"
    path.write_text("\n".join(messages(form, every)) + "\n", encoding="utf-8")
    tables = find_tables(path)
    if every == 1:  # no topic has more lines than the other
        assert tables[0].names[0] == "stamp"
        return
    (table,) = tables
    assert table.names == ("stamp", "wire_degC", "gap_mm")
    columns = {c.name: c.values for c in table.columns}
    np.testing.assert_allclose(columns["wire_degC"], U)
    np.testing.assert_allclose(columns["stamp"] - columns["stamp"][0], 1.5 * np.arange(U.size))
    notes = json_lines(messages(form, every)).notes
    assert any("'plant/rig2/readings'" in note and "'plant/rig2/state' (5)" in note for note in notes)


def test_a_topic_alone_stands_before_the_object(tmp_path):
    path = tmp_path / "messages.txt"
    path.write_text("\n".join(line for line in messages("") if "readings" in line) + "\n", encoding="utf-8")
    (table,) = find_tables(path)
    assert table.names == ("wire_degC", "gap_mm")


def test_objects_behind_words_that_differ_are_no_messages(tmp_path):
    path = tmp_path / "notes.txt"
    lines = [f"{k}th {chr(97 + k % 26)}{k} {json.dumps({'a': k})}" for k in range(20)]
    rows = [f"{k} {u} {u / 50:.3f}" for k, u in enumerate(U.tolist())]
    path.write_text("\n".join([*lines, "n T x", *rows]) + "\n", encoding="utf-8")
    (table,) = find_tables(path)
    assert table.names == ("n", "T", "x")
