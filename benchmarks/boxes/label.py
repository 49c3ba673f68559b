"""The label of a sealed box: the effects, and their influence on the settled points without noise.

It is stored as JSON. Its SHA-256 is a commitment that can be published before the diagnosis.
"""

import hashlib
import json
from dataclasses import asdict, dataclass
from typing import Any

EMPTY, HARD_NULL, ONE, TWO = "empty", "hard_null", "one", "two"
KINETIC, UNLISTED_CATEGORY = "kinetic", "unlisted"


@dataclass(frozen=True)
class RunTruth:
    """One run: targets of its settled points (K), clean outputs with and without the effects (rig unit)."""

    name: str
    held_out: bool
    targets: tuple[float, ...]
    with_effects: tuple[float, ...]
    without: tuple[float, ...]


@dataclass(frozen=True)
class Label:
    """The truth of a box.

    ``effects``: parameters by name; ``left_out``: the effect that is missing from the catalogue of the diagnosis;
    ``noise_counts``: standard deviation of a settled point about its clean output, including the ambient fluctuation
    and its trace in the hysteresis.
    """

    seed: int
    number: int
    category: str
    effects: dict[str, dict[str, float]]
    left_out: str
    arrangement: str
    channels: tuple[str, ...]
    noise_counts: float
    per_count: float
    draught_K: float
    runs: tuple[RunTruth, ...]

    def to_json(self) -> str:
        """The label as JSON with sorted keys and all digits, so that equal labels give equal texts."""
        return json.dumps(asdict(self), sort_keys=True, separators=(",", ":"))

    @classmethod
    def from_json(cls, text: str) -> "Label":
        """The label from ``to_json``."""
        data = json.loads(text)
        data["runs"] = tuple(_run_truth(run) for run in data["runs"])
        return cls(**(data | {"channels": tuple(data["channels"])}))

    @property
    def commitment(self) -> str:
        """SHA-256 of the JSON."""
        return hashlib.sha256(self.to_json().encode()).hexdigest()


def _run_truth(run: dict[str, Any]) -> RunTruth:
    columns = {k: tuple(v) for k, v in run.items() if isinstance(v, list)}
    return RunTruth(name=run["name"], held_out=run["held_out"], **columns)
