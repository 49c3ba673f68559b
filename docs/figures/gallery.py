"""All figures by name; the name is that of the SVG file."""

from collections.abc import Callable
from pathlib import Path

from figures import curves, diagnosed, memory, rig, safety, shaft
from figures.canvas import Picture

FOLDER = Path(__file__).resolve().parent
PICTURES: dict[str, Callable[[], Picture]] = {
    "relay": memory.relay,
    "boundary": memory.boundary,
    "wiping_out": memory.wiping_out,
    "congruency": memory.congruency,
    "everett": curves.everett,
    "density": curves.density,
    "lag": rig.lag,
    "initialisation": rig.initialisation,
    "energy": curves.energy,
    "signatures": diagnosed.signatures,
    "one_input": shaft.one_input,
    "repeating": safety.repeating,
    "lease": safety.lease,
}
