"""The map of how far one input describes two antagonist wires, drawn from the table on its page."""

import re
from pathlib import Path

from figures.canvas import Picture, plain, tenths

PAGE = Path(__file__).resolve().parents[1] / "explanation" / "one_input.md"
ROW = re.compile(r"^\| (\d+) MPa \([\d.]+ N mm\) \| ±(\d+) \|(.+)\|$", re.M)
CELL_W, CELL_H, LEFT, TOP, GAP_X, GAP_Y = 37, 26, 70, 64, 20, 74
DARKEST = 0.4  # share of the range
PRE_STRAINS = ("1", "2", "3", "4")
Key = tuple[int, int, int]  # load in MPa, amplitude in K, pre-strain in percent


def one_input() -> Picture:
    """Counts by load, pre-strain and amplitude, shaded by their share of the range."""
    found = _cells()
    loads, tops = (sorted({key[k] for key in found}) for k in (0, 1))
    width, height = CELL_W * len(PRE_STRAINS), CELL_H * len(tops)
    picture = Picture(
        740,
        356,
        "Largest errors in counts by load, pre-strain and amplitude; darker cells are a larger share of the range.",
    )
    for row, words in enumerate(
        ("both wires 1 K warmer at the same T₁ − T₂", "an extremum missed (wiping-out)")
    ):
        y = TOP + row * (height + GAP_Y)
        picture.add_text(LEFT, y - 34, f"Counts: {words}", "title f-ink")
        for k, load in enumerate(loads):
            x = LEFT + k * (width + GAP_X)
            picture.add_text(x + width / 2, y - 10, f"load {load} MPa", "small middle f-ink")
            for j, top in enumerate(reversed(tops)):
                if k == 0:
                    picture.add_text(x - 8, y + (j + 0.65) * CELL_H, f"±{top} K", "small end f-ink")
                for i, strain in enumerate(PRE_STRAINS):
                    counts = found[load, top, int(strain)]
                    _cell(picture, x + i * CELL_W, y + j * CELL_H, counts[1 + row], counts[0])
            for i, strain in enumerate(PRE_STRAINS):
                picture.add_text(x + (i + 0.5) * CELL_W, y + height + 16, f"{strain} %", "small middle f-ink")
    picture.add_text(
        LEFT,
        346,
        f"Columns: pre-strain. Shade: share of the range, darkest from {DARKEST:.0%}.",
        "small f-ink",
    )
    return picture


def _cell(picture: Picture, x: float, y: float, counts: float, travel: float) -> None:
    share = min(counts / travel / DARKEST, 1.0)
    box = f'x="{tenths(x)}" y="{tenths(y)}" width="{CELL_W}" height="{CELL_H}"'
    picture.add(f'<rect {box} class="f-heat s-ground" fill-opacity="{0.08 + 0.72 * share:.2f}"/>')
    picture.add_text(x + CELL_W / 2, y + 0.65 * CELL_H, plain(round(counts)), "small middle f-ink")


def _cells() -> dict[Key, tuple[float, float, float]]:
    """Range, counts of one kelvin, and counts of the wiping-out test, from the rows of the page."""
    found: dict[Key, tuple[float, float, float]] = {}
    for load, top, rest in ROW.findall(PAGE.read_text(encoding="utf-8")):
        for strain, cell in zip(PRE_STRAINS, rest.split("|"), strict=True):
            travel, warm, missed = (float(text) for text in cell.split("/"))
            found[int(load), int(top), int(strain)] = travel, warm, missed
    return found
