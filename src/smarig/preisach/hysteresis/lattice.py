"""The lattice on which the mass of a hysteresis is summed cell by cell."""

from functools import singledispatch

import numpy as np

from smarig.core import Array
from smarig.preisach.everett import Everett
from smarig.preisach.hysteresis.fod_table import FodTable


@singledispatch
def lattice(hysteresis: Everett, cells: int) -> Array:
    """Rising inputs from u₋ to u₊: the nodes of a FOD table, or else ``cells`` + 1 evenly spaced ones.

    >>> from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
    >>> lattice(thesis_surface("two_c"), 2).tolist()
    [-185.0, 0.0, 185.0]
    """
    return np.linspace(hysteresis.lower, hysteresis.upper, cells + 1)


@lattice.register
def _lattice_of_table(hysteresis: FodTable, cells: int) -> Array:
    del cells
    return hysteresis.nodes
