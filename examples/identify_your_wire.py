"""Identify your wire: measure first-order curves, fit a Preisach model, and verify it on a held-out run.

Writes identified.model.json. What it shows: a small error on the training data proves little. What counts is the error
on held-out data, compared with the noise floor.
"""

from pathlib import Path

import smarig
from smarig.identification import verify
from smarig.rig import TwinSettings
from smarig.runner import Session

CURVES, HELD_OUT = Path("curves.run.sqlite"), Path("held_out.run.sqlite")
for file in (CURVES, HELD_OUT):
    file.unlink(missing_ok=True)

# One session has one encoder zero, so the model predicts the second run without fitting an offset.
with Session("one_wire_twin", twin=TwinSettings(seed=3)) as session:
    session.run("first_order_descending", {}, CURVES)
    session.run("validation", {"points": 15}, HELD_OUT)

for surface in ("constant", "exponential", "positive"):
    found = smarig.identify(CURVES, surface=surface)
    verified = verify(found.model, smarig.load_run(HELD_OUT)).runs[0]
    floor_mm = verified.noise_floor or float("nan")
    print(
        f"{surface:12s} rms error: fit {found.model.fit['rms']:.4f} mm, held-out run {verified.settled.rms:.4f} mm "
        f"(n = {verified.settled.n}, noise floor {floor_mm:.4f} mm)"
    )

best = smarig.identify(CURVES, surface="exponential").model
best.save("identified.model.json", force=True)
print(best)
print(
    "This twin is itself an exponential surface, so this surface fits best by construction. A real wire may differ."
)
