"""Pages are tested by what their figures contain; drawings have tests of their own."""

import json

import pytest

import smarig.report.drawing


@pytest.fixture(scope="package", autouse=True)
def figures_as_data():
    """Pages contain the data of each panel in place of its drawing."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(smarig.report.drawing, "svg_of", _data)
        yield


def _data(panel, label="", width_px=0):
    layout = dict(panel.layout)
    if label:
        layout["annotations"] = [*layout.get("annotations", ()), {"text": label}]
    text = json.dumps({"data": list(panel.data), "layout": layout}, allow_nan=False)
    return f'<svg></svg><script type="application/json">{text.replace("<", chr(92) + "u003c")}</script>'
