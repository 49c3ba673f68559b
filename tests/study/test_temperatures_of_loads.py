"""The page of several loads: their transformation temperatures stand in one table, a row each, by their load."""

import re

import numpy as np
import pytest

from smarig.study import StudyOptions, study

pytestmark = [pytest.mark.usefixtures("drawings"), pytest.mark.long("takes nine seconds")]
LOADS = {50: 60.0, 100: 65.0, 150: 70.0}  # MPa: A_s; A_f, M_s and M_f lie 8 K above, 4 K and 12 K below


def loop(A_s):
    """Two cycles of linear branches between plateaus."""
    u = np.concatenate([np.linspace(20, 110, 200), np.linspace(110, 20, 200)] * 2)
    heating = np.tile(np.repeat([True, False], 200), 2)
    start = np.where(heating, A_s, A_s - 12.0)
    y = np.clip((u - start) / 8.0, 0.0, 1.0)
    return np.column_stack(
        [np.arange(u.size), u, y + 0.001 * np.random.default_rng(3).standard_normal(u.size)]
    )


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loads")
    for load, A_s in LOADS.items():
        header = "time_s,temperature_C,strain_percent"
        np.savetxt(
            folder / f"wire_{load}MPa.csv", loop(A_s), delimiter=",", header=header, comments="", fmt="%.5f"
        )
    study(sorted(folder.glob("*.csv")), folder / "out", StudyOptions(diagnose=False))
    return (folder / "out" / "index.html").read_text(encoding="utf-8")


def test_each_load_has_a_row_with_its_temperatures(page):
    table = re.search(r"<table><caption>Temperatures\..*?</table>", page, re.DOTALL)[0]
    rows = re.findall(r'<th scope="row">(.*?)</th>(.*?)</tr>', table, re.DOTALL)
    assert [name.replace("\xa0", " ") for name, _ in rows] == [f"{load} MPa" for load in LOADS]
    for (_, cells), A_s in zip(rows, LOADS.values()):
        values = [float(v) for v in re.findall(r">([\d.]+)</td>", cells)]
        assert values == pytest.approx([A_s, A_s + 8, A_s - 4, A_s - 12], abs=0.7)


def test_the_tangents_of_each_run_can_be_opened(page):
    section = page[page.index("Tangents and figures of each run") :]
    drawn = set(re.findall(r"Cycle \d+ of \S*?_(\d+)MPa\S* with its tangents", section))
    assert drawn == {str(load) for load in LOADS}
