"""Figures that stand on several pages are equal."""

import re
import tomllib
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
MEASURED = tomllib.loads((DOCS / "explanation/comparison.toml").read_text(encoding="utf-8"))


def text(page):
    return (DOCS / page).read_text(encoding="utf-8")


def test_the_number_of_tested_faults():
    cells = re.search(r"tries all (\d+) cells", text("reference/faults.md"))[1]
    assert f"[the fault table](faults.md), {cells} cells" in text("reference/drivers.md")


@pytest.mark.parametrize("stress", ["100", "200", "300"])
def test_errors_of_a_load_that_was_left_out(stress):
    error = MEASURED["stresses"]["left_out"][stress]
    assert re.search(
        rf"\| sma_isobaric_2 \|[^|]*\| {stress} MPa \| {error:.3f} % \|", text("explanation/diagnosis.md")
    )


@pytest.mark.parametrize(
    ("row", "key"), [("`positive` (no", "positive"), ("`forc_density`, automatic", "loess")]
)
def test_errors_of_densities(row, key):
    line = next(line for line in text("reference/benchmarks.md").splitlines() if line.startswith(f"| {row}"))
    assert line.endswith(" | ".join(f"{mean:.4f} ± {sd:.4f}" for mean, sd in MEASURED["density"][key]) + " |")


def test_errors_of_unseen_curves():
    positive, nnls = MEASURED["identify"]["positive"], MEASURED["identify"]["nnls_cells"]
    page = text("reference/benchmarks.md")
    assert f"| 300 | {positive['rms']:.4f} | {positive['seconds']:.2f} |" in page
    first, *others = nnls["rms"]
    assert f"{first:.4f} / {' / '.join(f'{rms:.3f}' for rms in others)} |" in page
