"""Find the hidden effect: the zero of a twin creeps with every stroke, and a diagnosis has to find this effect.

Writes diagnosed.model.json if an effect is found. What it shows: a model can fit well and still be wrong. The diagnosis
compares what may be missing by predictions of data left out, names a cause only if the data identify it, and measures
the gain on held-out data.
"""

from pathlib import Path

import smarig
from smarig.plant import effects_from_pairs
from smarig.rig import TwinSettings
from smarig.runner import Session

HIDDEN = ["walking=0.5"]  # per cent of the travel, each cycle
PLAN = {"first_order_descending": {}, "validation": {"points": 15}}

files = {name: Path(f"hidden_{name}.run.sqlite") for name in PLAN}
for file in files.values():
    file.unlink(missing_ok=True)
with Session("one_wire_twin", twin=TwinSettings(seed=2, effects=effects_from_pairs(HIDDEN))) as session:
    for name, settings in PLAN.items():
        session.run(name, settings, files[name])

curves, held_out = files["first_order_descending"], files["validation"]
model = smarig.identify(curves, surface="positive").model
print(f"The model fits its own points with an rms error of {model.fit['rms']:.4f} mm. Is it correct?")

found = smarig.diagnose(model, curves, held_out)
print(found.text())
print(f"Hidden in the twin was {HIDDEN[0]}.")
if found.extended:
    found.model.save("diagnosed.model.json", force=True)
