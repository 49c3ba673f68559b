"""An effect of your own: a mechanism that a twin can have and a diagnosis can look for.

    y = y₀ + s (ȳ − y₀),    dȳ/dt = (y₀ − ȳ) / t₀

Here: the mount is compliant, so a share s of every move arrives late. Replace it by your equation.

Plant it:       smarig run validation --rig one_wire_twin --effect ./my_effect.py=5 -o planted.run.sqlite
Look for it:    smarig diagnose MODEL --train RUN… --effect ./my_effect.py
"""

from collections.abc import Mapping
from math import exp

from smarig.plant import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    """What it changes, by stage: begins anew at every call, and keeps what it remembers in here.

    It is not called at strength 0: the plant is then untouched, bit for bit.
    """
    share, time_constant_s = p["share_percent"] / 100, p["time_constant_s"]
    late: float | None = None

    def output(y: float, now: PlantState) -> float:
        """The operator's output in the rig's unit, changed; ``now`` tells time, current, temperature, cycles."""
        nonlocal late
        late = y if late is None else y + (late - y) * exp(-now.dt_s / time_constant_s)  # right for any tick
        return y + share * (late - y)

    return {Stage.OUTPUT: output}  # the stages, and what passes by each, stand in smarig.plant.effect


my_effect = EffectType(  # the file's name, here and below
    name="my_effect",
    summary="The mount is compliant: a share of every move arrives late.",  # what `smarig list effects` shows
    number="own",
    enters="output map with a memory of its own",
    looks_like="positions lag behind, more after large moves",
    confused_with=("creep", "settling"),
    separated_by="longer holds",
    parameters=(  # the first is the strength, whose bounds hold 0: name, unit, lower, upper, typical, source
        Parameter("share_percent", "%", 0.0, 50.0, 5.0, "a guess: replace it"),
        Parameter(
            "time_constant_s", "s", 1.0, 3600.0, 60.0, "a guess: replace it", tries=(20.0, 60.0, 200.0)
        ),
    ),
    act=_act,
)
