"""Second-order transition curves (§3.5): needed for a nonlinear Preisach model, in addition to FOD curves."""

from smarig.core import Mark, Protocol, Settled
from smarig.protocols._building_blocks import checked_partition, evenly_spaced, saturate, settle_at
from smarig.protocols._setup import Setup


def second_order_transition(
    setup: Setup, *, partition_K: tuple[float, ...] = (), settle: Settled | None = None
) -> Protocol:
    """For every pair β < α of a partition: negative saturation → α → β → rising back towards α.

    The last, rising branches are of second order. They distinguish congruent from input-dependent hysteresis (§3.5).
    """
    settle = settle or Settled()
    levels = checked_partition(
        setup, partition_K or (setup.lower_K, *evenly_spaced(setup.lower_K, setup.upper_K, 6))
    )
    yield Mark("second-order transition", {"partition_K": list(levels)})
    for i in range(2, len(levels)):
        for j in range(1, i):
            yield from saturate(setup, settle)
            yield from settle_at(setup, [levels[i]], f"rise {i}", settle)
            yield from settle_at(setup, [levels[j]], f"fall {i}.{j}", settle)
            yield from settle_at(setup, levels[j + 1 : i + 1], f"return {i}.{j}", settle)
    yield from saturate(setup, settle)
