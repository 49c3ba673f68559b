"""The axes of a learned term of commanded runs."""

from types import SimpleNamespace
from typing import Any

import pytest

from smarig.plant import LEARNED_FROM, LearnedShape
from smarig.report.diagnosis.learned_law_figure import commanded_law_figure


def titles(variable, enters):
    shape = LearnedShape(variable, enters, (1.0, 2.0), "mm" if enters == "output" else "K")
    found: Any = SimpleNamespace(shape=shape, points=[[1.0, 0.0], [2.0, 0.5]])
    layout = commanded_law_figure(found, "mm", "TWIN").panels[0].layout
    return [layout[name]["title"]["text"] for name in ("xaxis", "yaxis")]


@pytest.mark.parametrize("variable", LEARNED_FROM)
@pytest.mark.parametrize("enters", ["output", "input"])
def test_every_variable_has_a_title_with_the_unit_of_its_values(variable, enters):
    x, y = titles(variable, enters)
    unit = {"time": "(s)", "hold": "(s)", "level": "(mm)", "step": "(K)", "history": "(K)"}.get(variable, "")
    unit = "(K)" if variable.startswith("power") else "(mm)" if variable.startswith("level") else unit
    assert x.endswith(unit)
    assert x.count("(") == (1 if unit or variable == "rate" else 0)
    assert y == {"output": "Added to the output (mm)", "input": "Added to the input (K)"}[enters]
