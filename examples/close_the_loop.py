"""Close a loop by a model: identify a wire, hold a set-point, follow a path, by the model's inverse and by plain PI.

What it shows: a controller that knows the hysteresis and looks ahead stays nearer to a moving path than one that waits
for an error. ``inverse`` is that one; ``pi`` has neither its memory nor the future.
"""

import smarig
from smarig.record import Run
from smarig.report import closed_loop_result, loop_result_text

RIG, SEED = "one_wire_twin", 4
MODEL = "loop.model.json"


def told(run: Run) -> str:
    """What the loop of a run did, in words; the figures themselves are attributes of ``closed_loop(run)``."""
    found = closed_loop_result(run)
    return loop_result_text(found, run.unit) if found else f"{run.path.name} holds no closed loop"


# A short identification: fewer curves than the protocol would measure by itself.
curves = smarig.run(
    "first_order_descending",
    rig=RIG,
    out="loop_curves.run.sqlite",
    seed=SEED,
    force=True,
    partition_K="0,15,30,40,50,65,85,110,140,170",
)
smarig.identify(curves, surface="exponential").model.save(MODEL, force=True)

# A set-point: to the state of that output which stands disturbances best, then a gentle loop, then a push of 5 K.
held = smarig.regulate(
    MODEL, 6.0, rig=RIG, out="loop_held.run.sqlite", seed=SEED, force=True, hold_s=150.0, disturbance_K=5.0
)
print(told(held))

# A path, in mm from the encoder's zero: the same wire, the same noise, two controllers.
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
    print(told(run))
