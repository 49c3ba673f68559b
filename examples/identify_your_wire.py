"""Identify your wire: measure first-order curves, fit a Preisach model, and verify it on a held-out run.

Writes identified.model.json. What it shows: a small error on the training data proves little. What counts is the error
on held-out data, compared with the noise floor.
"""

from pathlib import Path

import smarig
from smarig.identification import verify
from smarig.rig import TwinSettings
from smarig.runner import Session

CURVES, JUDGE = Path("curves.run.sqlite"), Path("judge.run.sqlite")
for file in (CURVES, JUDGE):
    file.unlink(missing_ok=True)

# One session has one encoder zero, so the model predicts the second run without fitting an offset.
with Session("one_wire_twin", twin=TwinSettings(seed=3)) as session:
    session.run("first_order_descending", {}, CURVES)
    session.run("validation", {"points": 15}, JUDGE)

for surface in ("constant", "exponential", "positive"):
    found = smarig.identify(CURVES, surface=surface)
    judged = verify(found.model, smarig.load_run(JUDGE)).runs[0]
    floor_mm = judged.noise_floor or float("nan")
    print(
        f"{surface:12s} fit {found.model.fit['rms']:.4f} mm rms, unseen run {judged.settled.rms:.4f} mm rms "
        f"(n = {judged.settled.n}, noise {floor_mm:.4f} mm)"
    )

best = smarig.identify(CURVES, surface="exponential").model
best.save("identified.model.json", force=True)
print(best)
print(
    "This twin is itself an exponential surface, so that one wins by construction; a wire may choose otherwise."
)
