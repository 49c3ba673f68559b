"""Close a loop with a model: identify a wire, hold a set-point, and track a reference with the inverse and with PI.

What it shows: a controller that uses the hysteresis model and preview (``inverse``) follows a moving reference more
closely than one that reacts to the error only (``pi``).
"""

import smarig
from smarig.record import Run
from smarig.report import closed_loop_result, loop_result_text

RIG, SEED = "one_wire_twin", 4
MODEL = "loop.model.json"


def loop_summary(run: Run) -> str:
    """The result of the loop as text; the figures are attributes of ``closed_loop_result(run)``."""
    found = closed_loop_result(run)
    return loop_result_text(found, run.unit) if found else f"{run.path.name} has no closed loop"


# A short identification: fewer curves than the default of the protocol.
curves = smarig.run(
    "first_order_descending",
    rig=RIG,
    out="loop_curves.run.sqlite",
    seed=SEED,
    force=True,
    partition_K="0,15,30,40,50,65,85,110,140,170",
)
smarig.identify(curves, surface="exponential").model.save(MODEL, force=True)

# A set-point: the state B_ℓ of this output is the least sensitive to disturbances.
# Then a PI loop with a small gain, and a disturbance of 5 K.
held = smarig.regulate(
    MODEL, 6.0, rig=RIG, out="loop_held.run.sqlite", seed=SEED, force=True, hold_s=150.0, disturbance_K=5.0
)
print(loop_summary(held))

# A reference, in mm from the encoder's zero: the same wire, the same noise, two controllers.
for controller in ("inverse", "pi"):
    run = smarig.track(
        MODEL,
        "multisine",
        rig=RIG,
        out=f"loop_{controller}.run.sqlite",
        seed=SEED,
        force=True,
        controller=controller,
        low=2.0,
        high=8.0,
        seconds=80.0,
        speed=3.0,
    )
    print(loop_summary(run))
