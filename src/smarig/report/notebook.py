"""One picture for notebooks: what a run measured, and what a model says of it."""

import plotly.graph_objects as go

from smarig.identification.model_file import Model
from smarig.identification.verify import verify
from smarig.record import Run


def plot(run: Run, model: Model | None = None) -> go.Figure:
    """Hysteresis graph of a run: settled points (or all samples) over the input, with a model if given.

    Returns a plotly figure; in a notebook it shows itself, ``figure.write_html(path)`` keeps it.
    """
    inputs, outputs = run.points()
    label = "twin" if run.twin else run.meta.get("source", "measured")
    figure = go.Figure()
    figure.add_scatter(
        x=inputs, y=outputs, mode="lines+markers", name=f"measured ({label})", marker={"size": 6}
    )
    if model is not None:
        predicted = verify(model, [run]).runs[0].predicted
        figure.add_scatter(
            x=inputs, y=predicted, mode="markers", name="model", marker={"symbol": "x", "size": 7}
        )
    quantity = run.meta.get("input", {}).get("quantity", "input")
    figure.update_layout(
        title=f"{run.meta.get('protocol', '')} on {run.meta.get('rig', '')}",
        xaxis_title=f"{quantity} ({run.input_unit})",
        yaxis_title=f"{run.meta.get('output', {}).get('quantity', 'output')} ({run.unit})",
        template="plotly_white",
    )
    return figure
