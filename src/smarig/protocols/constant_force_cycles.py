"""Full heating and cooling cycles in settled steps: transformation temperatures, stroke and their drift."""

from smarig.core import Mark, Protocol, Settled, UsageError
from smarig.protocols._building_blocks import checked_count, checked_inputs, evenly_spaced, settle_at
from smarig.protocols._setup import Setup


def constant_force_cycles(
    setup: Setup,
    *,
    cycles: int = 2,
    points: int = 40,
    lower_K: float | None = None,
    upper_K: float | None = None,
    settle: Settled | None = None,
) -> Protocol:
    """Full heating and cooling cycles between two settled ends, as in ASTM E3097; the load is that of the rig.

    ``points`` are the holds of each branch. ``lower_K`` and ``upper_K`` are the lower and upper cycle temperatures
    above ambient; by default the ends of the rig's range. Both should lie well outside the transformation: the output
    must be seen to level off at both ends (``smarig transformation``).
    """
    checked_count("cycles", cycles, 1, 10_000)
    checked_count("points", points, 10, 10_000)
    settle = settle or Settled()
    low = checked_inputs(setup, [setup.lower_K if lower_K is None else lower_K], "lower_K")[0]
    high = checked_inputs(setup, [setup.upper_K if upper_K is None else upper_K], "upper_K")[0]
    if not low < high:
        raise UsageError(f"lower_K must be below upper_K; got {low:g} and {high:g}.")
    limits = {"lower_K": low, "upper_K": high}
    yield Mark("constant-force cycles", {"cycles": cycles, "points": points, **limits})
    yield from settle_at(setup, [low], "start", settle)
    for k in range(1, cycles + 1):
        yield from settle_at(setup, evenly_spaced(low, high, points), f"heating {k}", settle)
        yield from settle_at(setup, evenly_spaced(high, low, points), f"cooling {k}", settle)
