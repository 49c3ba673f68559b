"""Readings of exactly 0 far from their neighbours, in units whose 0 is another value of the run, as 0 K is −273.15 °C.

Where 0 stays 0, whatever reads the run finds them in it.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, shown, spaced
from smarig.measurement import dropouts
from smarig.record import ImportFinding


def without_dropped(
    column: str, unit: str, x: Array, written: Array, line: NDArray[np.int64]
) -> tuple[Array, list[ImportFinding]]:
    """The values (n,) of a run with NaN where the file, whose values are ``written`` in ``unit``, reads exactly 0 far
    from its neighbours, and a finding on them; all values if 0 stays 0.
    """
    lost = drops(written) & np.isfinite(x) & (x != 0)
    if not lost.any():
        return x, []
    text = (
        f"Column {shown(column)} reads exactly 0{spaced(unit)} in {int(lost.sum())} rows, far from the rows "
        f"around them (first: line {line[lost][0]}): drop-outs of the instrument. They are masked."
    )
    return np.where(lost, np.nan, x), [ImportFinding(text, "drop-outs")]


def drops(x: Array, code: float = 0.0) -> NDArray[np.bool_]:
    """Mask of the readings (n,) of exactly ``code``, far from their neighbours; others may be NaN.

    >>> drops(np.array([290.0, 291.0, np.nan, 0.0, 293.0, 294.0])).tolist()
    [False, False, False, True, False, False]
    """
    mask, known = np.zeros(x.size, dtype=bool), np.isfinite(x)
    mask[known] = dropouts(x[known], code)
    return mask
