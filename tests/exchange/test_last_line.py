"""The last line of a file without an end: a row that is cut is dropped, words are a footer."""

import numpy as np
import pytest

from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

ROWS = 70
U = np.round(55 - 30 * np.cos(np.linspace(0, 4 * np.pi, ROWS)), 1)
X = np.round(4 + 3 * np.tanh((U - np.where(np.gradient(U) > 0, 60, 50)) / 6), 3)
CLOCKS = {
    "seconds": lambda k: f"{k / 2:.1f}",
    "stamp": lambda k: f"2024-02-03T10:{k // 60:02}:{k % 60:02}.000Z",
}
FOOTERS = [
    "End of file",
    '"Ende der Messdaten"',
    "*** Fin de l'essai ***",
    "Mean;52.1",
    "Stopped at 14:05",
    "Größtwert;5",
]


def imported(path):
    (table,) = find_tables(path)
    mapping = path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess_table(table), "m"), encoding="utf-8")
    report = import_file(path, format="csv", out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    return load_run(report.run), [finding.text for finding in report.findings]


def lines(sign, clock):
    rows = [sign.join((clock(k), str(u), str(x))) for k, (u, x) in enumerate(zip(U, X))]
    return [sign.join(("time [s]" if clock is CLOCKS["seconds"] else "time", "T [degC]", "x [mm]")), *rows]


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("sign", [";", "\t"])
@pytest.mark.parametrize("blank", [0, 1])
@pytest.mark.parametrize("footer", FOOTERS)
def test_words_are_a_footer(write, sign, blank, footer):
    text = [*lines(sign, CLOCKS["seconds"]), *[""] * blank, footer.replace(";", sign)]
    run, findings = imported(write("\n".join(text)))
    np.testing.assert_allclose(run["position"], X)
    assert not [text for text in findings if "incomplete" in text]
    assert [text for text in findings if f"lines from {ROWS + 2 + blank} on" in text]


@pytest.mark.parametrize("clock", CLOCKS.values(), ids=CLOCKS)
@pytest.mark.parametrize("left", [1, 2, 12, 25])
def test_a_row_that_is_cut_is_dropped(write, clock, left):
    every = lines(";", clock)
    row = every[-1]
    if left >= len(row) or row[:left].count(";") == 2:
        pytest.skip("no cell is missing")
    run, findings = imported(write("\n".join([*every[:-1], row[:left]])))
    np.testing.assert_allclose(run["position"], X[:-1])
    assert np.isfinite(run["t_s"]).all()
    assert [text for text in findings if f"The last line ({ROWS + 1}) is incomplete" in text]
