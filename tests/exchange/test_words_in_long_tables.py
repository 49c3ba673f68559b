"""Words among the readings of a long table are masked and counted, and end no table."""

import json

import numpy as np
import pytest

from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

N = 300
T = np.round(50 - 28 * np.cos(np.linspace(0, 4 * np.pi, N)), 1)
X = np.round(6 + 4 * np.tanh((T - np.where(np.gradient(T) > 0, 55, 41)) / 5), 2)
NAMES = ("sensor.wire_temperature_degC", "sensor.stroke_mm", "switch.fan", "binary_sensor.door")


def states(words, apart):
    """(entity, state, time): ``words`` by variable and reading; switches turn at times of their own or of readings."""
    rows = [
        (name, words.get((j, k), str(v)), 4 * k)
        for j, (name, x) in enumerate(zip(NAMES, (T, X)))
        for k, v in enumerate(x)
    ]
    switches = [(NAMES[2 + k % 2], ("on", "off")[k // 2 % 2], 4 * (10 + 20 * k) + apart) for k in range(8)]
    return [
        (name, state, f"2024-06-01T{8 + t // 3600:02}:{t // 60 % 60:02}:{t % 60:02}Z")
        for name, state, t in [*rows, *switches]
    ]


def csv_of(rows):
    return "\n".join(["entity_id,state,last_changed", *map(",".join, rows)]) + "\n"


def json_of(rows):
    return "".join(json.dumps(dict(zip(("entity_id", "state", "last_changed"), r))) + "\n" for r in rows)


def imported(path):
    (table,) = find_tables(path)
    mapping = path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess_table(table), "m"), encoding="utf-8")
    report = import_file(path, format=table.format, out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    return load_run(report.run), [finding.text for finding in report.findings]


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("apart", [0, 1])
@pytest.mark.parametrize(("text", "header"), [(csv_of, 1), (json_of, 0)])
@pytest.mark.parametrize(
    ("words", "said"),
    [
        ({(0, 120): "unavailable"}, ["'unavailable' (1, first in line 121)"]),
        (
            {(j, k): "unavailable" for k in (90, 91, 170) for j in (0, 1)},  # of both at once
            ["'unavailable' (6, first in line 91)"],
        ),
        (
            {(0, 30): "unknown", (0, 31): "unknown", (1, 0): "unknown", (1, 200): "door open"},
            ["'unknown' (3, first in line 31)", "'door open' (1, first in line 501)"],
        ),
    ],
)
def test_words_are_masked_and_counted(write, words, said, text, header, apart):
    run, findings = imported(write(text(states(words, apart))))
    t, x = run["temperature_degC"], run["position"]
    assert len(run) == N
    masked = [np.flatnonzero(np.isnan(column)).tolist() for column in (t, x)]
    assert masked == [[k for j, k in sorted(words) if j == which] for which in (0, 1)]
    np.testing.assert_allclose(t[np.isfinite(t)], T[np.isfinite(t)])
    (note,) = [finding for finding in findings if "Words among the readings" in finding]
    for part in said:
        word, _, line = part.removesuffix(")").rpartition(" ")
        assert f"{word} {int(line) + header})" in note
    assert any("no readings of them are left out: 8 ('switch.fan'" in finding for finding in findings)
