"""A cause that a verdict names, with what is known of its parameters."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Finding:
    """A cause of the verdict: an effect with its probability, and by parameter the value, 95 % interval and unit."""

    name: str
    probability: float
    parameters: Mapping[str, Mapping[str, Any]]

    def to_json(self) -> dict[str, Any]:
        """An entry of ``effects`` of the command line."""
        parameters = {name: dict(value) for name, value in self.parameters.items()}
        return {"name": self.name, "probability": self.probability, "parameters": parameters}
