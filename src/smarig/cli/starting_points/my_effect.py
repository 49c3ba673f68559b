"""An effect of your own: a mechanism that a twin can have and that a diagnosis can find.

    y = y₀ + s (ȳ − y₀),    dȳ/dt = (y₀ − ȳ) / t₀

In this example the mount is compliant, so a share s of every movement is delayed. Replace it with your equation.

Inject it:  smarig run validation --rig one_wire_twin --effect ./my_effect.py=5 -o injected.run.sqlite
Find it:    smarig diagnose MODEL --train RUN… --effect ./my_effect.py
"""

from collections.abc import Mapping
from math import exp

from smarig.plant import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    """The functions of the effect by stage. Each call creates a new state, which stays in this function.

    It is not called at strength 0, so the plant is then unchanged, bit for bit.
    """
    share, time_constant_s = p["share_percent"] / 100, p["time_constant_s"]
    delayed: float | None = None

    def output(y: float, now: PlantState) -> float:
        """The changed output, in the rig's unit. ``now`` holds time, current, temperature and cycles."""
        nonlocal delayed
        delayed = (
            y if delayed is None else y + (delayed - y) * exp(-now.dt_s / time_constant_s)
        )  # for any tick
        return y + share * (delayed - y)

    return {Stage.OUTPUT: output}  # smarig.plant.effect lists the stages and their quantities


my_effect = EffectType(  # variable and ``name`` must equal the file's name
    name="my_effect",
    summary="The mount is compliant: part of every movement is delayed.",  # shown by `smarig list effects`
    number="own",
    enters="output map with a memory of its own",
    looks_like="positions lag behind, more after large moves",
    confused_with=("creep", "settling"),
    separated_by="longer holds",
    remedy="stiffen the mount",
    parameters=(  # name, unit, lower, upper, typical, source; the first is the strength, with 0 within its bounds
        Parameter("share_percent", "%", 0.0, 50.0, 5.0, "placeholder, replace it"),
        Parameter(
            "time_constant_s", "s", 1.0, 3600.0, 60.0, "placeholder, replace it", tries=(20.0, 60.0, 200.0)
        ),
    ),
    act=_act,
)
