"""CONTRIBUTING.md and tests/README.md name what exists, all of it, in the order of the layers."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PLACES = ("src/", "tests/", "docs/", "configs/", "simulators/", "benchmarks/", "firmware_protocol/", ".ci/")


def _table_rows(page: str, heading: str) -> list[str]:
    """First cells of the table under a heading."""
    section = page.split(heading, 1)[1].split("\n## ", 1)[0]
    return [line.split("|")[1] for line in section.splitlines() if line.startswith("| `")]


def test_the_tour_follows_the_layers():
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    layers = next(c["layers"] for c in contracts if c["name"].startswith("Layers"))
    upwards = [sorted(re.findall(r"\w+", layer)) for layer in reversed(layers) if layer != "__main__"]
    page = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    rows = [sorted(re.findall(r"`(\w+)`", cell)) for cell in _table_rows(page, "## The ten-minute tour")]
    assert rows == upwards


def test_the_index_of_tests_names_every_folder():
    page = (ROOT / "tests/README.md").read_text("utf-8")
    folders = {p.name for p in (ROOT / "tests").iterdir() if p.is_dir() and not p.name.startswith(("_", "."))}
    rows = [cell.strip(" `") for cell in _table_rows(page, "# The tests")]
    assert len(rows) == len(set(rows))
    assert set(rows) == folders


@pytest.mark.parametrize("name", ["CONTRIBUTING.md", "SECURITY.md", "tests/README.md"])
def test_every_path_exists(name):
    page = (ROOT / name).read_text("utf-8")
    links = re.findall(r"\]\(([^)#:]+)\)", page)
    assert not [link for link in links if not ((ROOT / name).parent / link).exists()]
    paths = [p for p in re.findall(r"`([^`\s]+)`", page) if p.startswith(PLACES)]
    missing = [p for p in paths if not list(ROOT.glob(p.removesuffix("NAME.py")))]
    assert not missing


def test_every_module_of_the_tour_and_the_journey_exists():
    page = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    tour = page.split("## The ten-minute tour", 1)[1].split("## Typical changes", 1)[0]
    modules = re.findall(r"`([a-z_/]+\.py)`", tour)
    assert len(modules) > 20
    assert not [m for m in modules if not list((ROOT / "src/smarig").glob(f"**/{m}"))]
