"""Values of searched parameters: no two of them are one but for rounding."""

import numpy as np
import pytest

from smarig.diagnosis.comparison.measured.hypothesis_search import _around, vertex


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("first", [0.1, 0.3, 0.0091017, 7.7])
@pytest.mark.parametrize("step", [2 / 3, 0.1, 1 / 7])
def test_finer_values_meet_the_options(first, step):
    options = [first * (1 + step * k) for k in range(9)]
    for best in options:
        values = np.array(sorted({*options, *_around(best, options)}))
        assert (np.diff(values) > 1e-9 * values[1:]).all()
        assert vertex(dict.fromkeys(values.tolist(), 0.0) | {best: 1.0}) is None or best not in (
            values[0],
            values[-1],
        )
