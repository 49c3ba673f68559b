"""Find the hidden effect: a twin whose zero creeps with every stroke, and a diagnosis that has to find that out.

Writes diagnosed.model.json where something was found. What it shows: a model can fit well and still be wrong; the
misfit is tested against chance, a cause is named only where the data can tell, and the gain is measured elsewhere.
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

curves, judge = files["first_order_descending"], files["validation"]
model = smarig.identify(curves, surface="positive").model
print(f"The model fits its own points to {model.fit['rms']:.4f} mm rms. Is that all there is to know?")

# Few empty stories, to be quick: 60 can support no finer a claim than p = 1/61. A real question deserves 400.
found = smarig.diagnose(model, curves, judge, nulls=60)
print(found.text())
print(f"Hidden in the twin was {HIDDEN[0]}.")
if found.extended:
    found.model.save("diagnosed.model.json", force=True)
