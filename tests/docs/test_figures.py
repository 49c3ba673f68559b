"""The figures of the documentation equal the output of their scripts.

Two need whole diagnoses and experiments, which take seconds; they are compared in the long campaign.
"""

import doctest
import importlib
import os
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
NAMES = sorted(p.stem for p in (DOCS / "figures").glob("*.svg"))
SLOW = {"lookalikes", "signatures"}
ONE_PIXEL = 1.0  # what another machine's rounding may move
ALL_BYTES = 500_000
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


@pytest.fixture
def gallery(monkeypatch):
    monkeypatch.syspath_prepend(DOCS)
    return importlib.import_module("figures.gallery")


@pytest.mark.parametrize("name", NAMES)
def test_a_picture_is_what_its_script_draws(name, gallery):
    if name in SLOW and not os.environ.get("SMARIG_LONG"):
        pytest.skip("drawn in the long campaign")
    kept = (gallery.FOLDER / f"{name}.svg").read_text(encoding="utf-8")
    drawn = gallery.PICTURES[name]().svg()
    assert same(kept, drawn), f"{name}.svg is stale: in docs/, python -m figures {name}"


def same(kept, drawn):
    """The same words and shapes, every number within a pixel."""
    if NUMBER.sub("#", kept) != NUMBER.sub("#", drawn):
        return False
    pairs = zip(NUMBER.findall(kept), NUMBER.findall(drawn), strict=True)
    return all(abs(float(a) - float(b)) <= ONE_PIXEL for a, b in pairs)


def test_a_moved_line_is_noticed():
    assert same("<path d='M1 2L30 4'/>", "<path d='M1 2.4L30 4'/>")
    assert not same("<path d='M1 2L30 4'/>", "<path d='M1 2L36 4'/>")
    assert not same("<text>4 mm</text>", "<text>4 K</text>")


def test_every_picture_is_kept_shown_and_described(gallery):
    """One file for each script and a page for each file, with words for those who do not see it."""
    assert set(NAMES) == set(gallery.PICTURES)
    pages = "".join(p.read_text(encoding="utf-8") for p in DOCS.rglob("*.md"))
    for name in NAMES:
        assert re.search(rf"!\[[^\]]{{20,}}\]\([./]*figures/{name}\.svg\)", pages), (
            f"no page describes {name}.svg"
        )
        root = ElementTree.parse(gallery.FOLDER / f"{name}.svg").getroot()
        title = root.find("{http://www.w3.org/2000/svg}title")
        assert title is not None
        assert title.text


def test_pictures_are_light_and_fit_both_themes():
    files = [DOCS / "figures" / f"{name}.svg" for name in NAMES]
    assert sum(f.stat().st_size for f in files) < ALL_BYTES
    for file in files:
        text = file.read_text(encoding="utf-8")
        assert "prefers-color-scheme:dark" in text, file.name
        assert not re.search(r"(href|url\()", text), f"{file.name} asks for something outside itself"


def test_examples_in_the_canvas(gallery):
    found = doctest.testmod(importlib.import_module("figures.canvas"))
    assert found.attempted
    assert not found.failed
