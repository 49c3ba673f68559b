"""Sealed boxes for a blind diagnosis: recorded runs of imaginary wires with nothing, one or two effects hidden.

Shares no code with what will look for them: own relays, own heat, own equations of every effect. From the rest
of the project it takes errors and the format of a run file, and nothing else.
"""

from smarig.benchmark.boxes.drawing import Box, draw
from smarig.benchmark.boxes.label import Label, RunTruth
from smarig.benchmark.boxes.sealing import Sealed, generate

__all__ = ["Box", "Label", "RunTruth", "Sealed", "draw", "generate"]
