"""The headline figures of a study: what an interval does not show is told beside it."""

from types import SimpleNamespace
from typing import Any

import pytest

from smarig.study.key_figures import _drift_text


@pytest.mark.parametrize(
    ("ends", "told"),
    [((-0.2, -0.15), "; drifts by −0.18 K a cycle"), ((-0.4, 0.05), ""), (None, "")],
)
def test_a_drift_from_cycle_to_cycle_is_told(ends, told):
    drift = {} if ends is None else {"A_s": SimpleNamespace(value=-0.177, ci95=ends)}
    found: Any = SimpleNamespace(drift=drift, unit_of=lambda _: "K")
    assert _drift_text(found, "A_s") == told
