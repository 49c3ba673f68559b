"""The parts of an error are found where they were put."""

import numpy as np
import pytest

from smarig.diagnosis.error_parts import error_parts

N = 400
RUN = np.arange(N) // 100
BLOCK = np.arange(N) // 10
OUTPUT = np.tile(np.linspace(0.0, 1.0, 10), N // 10)
RNG = np.random.default_rng(3)
PUT = {
    "between_runs": np.array([1.0, -1.0, 0.5, -0.5])[RUN],
    "slow": np.cos(np.pi * 5 * (np.arange(N) + 0.5) / N),
    "branch": RNG.standard_normal(BLOCK.max() + 1)[BLOCK],
    "level": np.cos(2 * np.pi * OUTPUT),
    "fast": RNG.standard_normal(N),
}


@pytest.mark.parametrize("part", PUT)
def test_a_part_is_found_where_it_was_put(part):
    found = error_parts(PUT[part], RUN, BLOCK, OUTPUT)
    assert max(found, key=found.__getitem__) == part
    assert found[part] > 0.6
    assert sum(found.values()) == pytest.approx(1.0)


def test_no_error_has_no_parts():
    assert set(error_parts(np.zeros(N), RUN, BLOCK, OUTPUT).values()) == {0.0}
