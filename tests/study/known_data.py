"""Records of a play with known thresholds, and files of them in the styles of public instruments."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.exchange import FoundColumn, FoundTable

Array = NDArray[np.float64]


def temperatures(cycles: int = 4, rows: int = 120) -> Array:
    """Temperatures in °C of decaying cycles between 25 and 120."""
    phase = np.linspace(0, 2 * np.pi * cycles, cycles * rows)
    size = 47.5 * (1 - 0.12 * phase / (2 * np.pi))
    return 25 + size * (1 - np.cos(phase))


def displacements(u: Array, seed: int = 0, noise: float = 0.01) -> Array:
    """The mean of three plays of half widths 5, 10 and 15 K through a smooth step, in mm, with noise."""
    total = np.zeros(u.size)
    for r in (5.0, 10.0, 15.0):
        state = u[0]
        for k, value in enumerate(u):
            state = min(max(state, value - r), value + r)
            total[k] += 4.0 / (1 + np.exp(-(state - 70) / 8)) / 3
    return total + np.random.default_rng(seed).normal(0, noise, u.size)


def csv_text(t: Array, u: Array, x: Array) -> str:
    """As a LabVIEW or Excel export in a European locale: semicolons, decimal commas, a row of units."""
    lines = ["Messprogramm 2.1", "Datum: 03.05.2024", "", "Zeit;Temperatur Probe;Weg Laser", "s;°C;mm"]
    lines += [f"{a:.2f};{b:.3f};{c:.4f}".replace(".", ",") for a, b, c in zip(t, u, x)]
    return "\r\n".join(lines) + "\r\n"


def table_of(**columns) -> FoundTable:
    """A table found in a text, of columns by name."""
    made = tuple(FoundColumn(name, "", np.asarray(x, dtype=float)) for name, x in columns.items())
    return FoundTable(Path("data.csv"), "csv", "", made, {"file": {}}, {})
