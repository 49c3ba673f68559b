"""The page of a study: its first screen, the family of loads, and transformation temperatures."""

import numpy as np
import pytest

from smarig.study import StudyOptions, study
from study.known_data import displacements, temperatures

pytestmark = pytest.mark.usefixtures("drawings")
QUICK = StudyOptions(diagnose=False)


def _isobaric(folder, stress_MPa):
    """One loop at a stress that moves it by 1 K for 10 MPa, as text with three columns."""
    u = temperatures(1, 120)
    strain = 0.01 * displacements(u - stress_MPa / 10, seed=int(stress_MPa), noise=0.005)
    path = folder / f"wire_{stress_MPa}MPa.csv"
    rows = "\n".join(f"{a:.3f},{b:.6f},{stress_MPa}" for a, b in zip(u, -strain))
    path.write_text(f"temperature [°C],strain,stress [MPa]\n{rows}\n", encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def loads(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loads")
    return study([_isobaric(folder, s) for s in (50, 100, 150)], folder / "out", QUICK)


def _page(result):
    return (result.folder / "index.html").read_text(encoding="utf-8")


def test_the_loop_comes_before_everything_but_the_verdict(loads):
    page = _page(loads)
    first = page[page.index("<main>") : page.index('id="section-2"')]
    assert first.index("notice") < first.index("<svg") < first.index("<table")
    assert 'class="with-text"' in first


def test_the_family_of_loads_is_drawn_with_the_held_out_one(loads):
    assert loads.split.kind == "load"
    page = _page(loads)
    drawn = page[page.index('class="plot"') :].split(">", 1)[0]
    for name in ("50 MPa, fitted", "150 MPa, fitted", "measured, 100 MPa", "model, 100 MPa"):
        assert name in drawn


def test_transformation_temperatures_and_their_dependence_on_stress_are_headline_figures(loads):
    slopes = {name: (value, ends) for name, value, ends in loads.transformation.slopes}
    assert slopes["A_s"][0] == pytest.approx(10, rel=0.25)
    low, high = slopes["A_s"][1]
    assert low < 10 < high
    said = "\n".join(loads.transformation.lines())
    assert "wire_100MPa: A_s " in said
    assert "A_s rises by 1 K per " in said
    page = _page(loads)
    first = page[: page.index('id="section-2"')]
    for words in ("A<sub>s</sub>", "A<sub>f</sub>", "M<sub>s</sub>", "M<sub>f</sub>", "rises 1 K per"):
        assert words in first


def test_a_run_without_a_full_loop_says_why(tmp_path):
    u = np.concatenate([np.linspace(120, 25, 150), np.linspace(25, 75, 60)])
    path = tmp_path / "half.csv"
    rows = "\n".join(f"{a:.3f},{b:.5f}" for a, b in zip(u, displacements(u)))
    path.write_text(f"temperature [°C],stroke [mm]\n{rows}\n", encoding="utf-8")
    result = study([path], tmp_path / "out", QUICK)
    assert result.transformation.result is None
    assert "contains no full loop" in result.transformation.lines()[0]
    assert "contains no full loop" in _page(result)
