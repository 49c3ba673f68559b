"""The output of a model along the input of a run, continued as samples come."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from smarig.preisach import Preisach
from smarig.replay import load_model


class ModelOverlay:
    """The Preisach operator of a model file, without its effects. Raises DataError for a file that is none."""

    def __init__(self, file: Path) -> None:
        model = load_model(file)
        self._operator = Preisach(model.hysteresis, "negative")
        self._range = model.hysteresis.lower, model.hysteresis.upper

    def outputs(self, inputs: Sequence[float | None]) -> list[float | None]:
        """The output at each input, in the unit of the model; None where there is no input."""
        known = [k for k, u in enumerate(inputs) if u is not None]
        if not known:
            return [None] * len(inputs)
        u = np.clip(np.array([inputs[k] for k in known], dtype=float), *self._range)
        y = self._operator.simulate(u, self._operator.state)
        found: list[float | None] = [None] * len(inputs)
        for k, output in zip(known, y.tolist()):
            found[k] = round(output, 6)
        return found
