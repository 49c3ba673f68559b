"""Sealed boxes for a blind diagnosis: recorded runs of synthetic wires with no effect, one or two effects.

This package shares no code with the diagnosis: it has its own relays, heat balance and equations of effects.
From the rest of the project it uses only the errors and the format of run files.
"""

from benchmarks.boxes.foreign_box import Part, draw_world_box
from benchmarks.boxes.label import Label, RunTruth
from benchmarks.boxes.random_box import Box, draw_box
from benchmarks.boxes.sealing import SealedBox, write_box

__all__ = ["Box", "Label", "Part", "RunTruth", "SealedBox", "draw_box", "draw_world_box", "write_box"]
