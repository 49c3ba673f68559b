"""The sheets of a run and of a characterisation print on one page, with their figures drawn."""

import re
import shutil
import subprocess

import pytest

import smarig
from report.browser import chromium
from report.few_effects import few_effects
from smarig.app.characterise import characterise
from smarig.cli import run as cli
from smarig.record import load_run
from smarig.report.summary_page import summary_page
from smarig.runner.session import Session

CAMPAIGN = """
name = "short"
summary = "Enough for every section of a page."
[[step]]
protocol = "first_order_descending"
purpose = "train"
set = { partition_K = [0, 50, 70, 90, 110, 160] }
[[step]]
protocol = "validation"
purpose = "held_out"
set = { points = 8 }
"""
pytestmark = pytest.mark.usefixtures("drawings")


@pytest.fixture(scope="module")
def full_loop(tmp_path_factory):
    """A run whose sheet has the temperatures too."""
    out = tmp_path_factory.mktemp("loop") / "full.run.sqlite"
    with Session("one_wire_twin", seed=1) as session:
        return load_run(session.run("constant_force_cycles", {"cycles": "1", "points": "20"}, out))


def printed_pages(page, folder):
    """How many pages Chromium prints a page on."""
    out = folder / "page.pdf"
    command = [chromium(), "--headless", "--no-sandbox", f"--user-data-dir={folder / 'profile'}"]
    subprocess.run(
        [*command, f"--print-to-pdf={out}", page.as_uri()], check=True, capture_output=True, timeout=120
    )
    return len(re.findall(rb"/Type\s*/Page[^s]", out.read_bytes()))


@pytest.mark.parametrize("with_model", [False, True])
def test_the_sheet_of_a_run(full_loop, with_model, tmp_path):
    page = tmp_path / "page.html"
    model = smarig.identify(full_loop, "positive").model if with_model else None
    page.write_text(summary_page(full_loop, model), encoding="utf-8")
    assert page.read_text(encoding="utf-8").count("<svg") >= 1 + with_model
    assert printed_pages(page, tmp_path) == 1


@pytest.mark.long("takes three seconds")
def test_the_sheet_of_two_days_compared(full_loop, tmp_path):
    page = tmp_path / "page.html"
    assert cli(["report", *[str(full_loop.path)] * 2, "--summary"]) == 2, "one file twice"
    other = tmp_path / "other.run.sqlite"
    shutil.copy(full_loop.path, other)
    assert cli(["report", str(full_loop.path), str(other), "--summary", "-o", str(page)]) == 0
    assert page.read_text(encoding="utf-8").count("<svg") >= 2
    assert printed_pages(page, tmp_path) == 1


@pytest.mark.long
def test_the_sheet_of_a_characterisation_with_a_cause(tmp_path):
    (tmp_path / "short.toml").write_text(CAMPAIGN, encoding="utf-8")
    with few_effects():
        characterise(
            "one_wire_twin",
            tmp_path / "out",
            campaign=str(tmp_path / "short.toml"),
            seed=2,
            effects=("walking=1",),
        )
    page = tmp_path / "out" / "summary.html"
    assert "Against walking" in page.read_text(encoding="utf-8")
    assert printed_pages(page, tmp_path) == 1


@pytest.mark.long("takes half a minute")
def test_the_sheet_of_a_whole_campaign_with_a_cause(tmp_path):
    """The longest: five runs, the temperatures, a cause with its remedy."""
    characterise("one_wire_twin", tmp_path / "out", effects=("walking=0.6",))
    page = tmp_path / "out" / "summary.html"
    assert "Against walking" in page.read_text(encoding="utf-8")
    assert printed_pages(page, tmp_path) == 1
