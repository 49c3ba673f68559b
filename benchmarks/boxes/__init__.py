"""Sealed boxes for a blind diagnosis: recorded runs of imaginary wires with nothing, one or two effects hidden.

Shares no code with what will look for them: own relays, own heat, own equations of every effect. From the rest
of the project it takes errors and the format of a run file, and nothing else.
"""

from benchmarks.boxes.label import Label, RunTruth
from benchmarks.boxes.random_box import Box, draw_box
from benchmarks.boxes.sealing import SealedBox, write_box

__all__ = ["Box", "Label", "RunTruth", "SealedBox", "draw_box", "write_box"]
