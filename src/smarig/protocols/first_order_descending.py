"""First-order descending (FOD) curves: the identification protocol of §3.4 and §5.4.1."""

from smarig.core import Mark, Protocol, Settled
from smarig.protocols._building_blocks import checked_partition, default_partition, saturate, settle_at
from smarig.protocols._setup import Setup


def first_order_descending(
    setup: Setup, *, partition_K: tuple[float, ...] = (), settle: Settled | None = None
) -> Protocol:
    """First-order descending curves over a partition: the identification data of a Preisach model.

    From negative saturation u₀ the input rises to α = u_i, then falls through u_{i−1} … u₀, for i = 1 … n. A
    partition of n segments gives n curves and n(n+3)/2 points y(α, β). The default is the thesis's partition,
    scaled to the rig's range.
    """
    settle = settle or Settled()
    levels = checked_partition(setup, partition_K or default_partition(setup))
    yield Mark("first-order descending", {"partition_K": list(levels)})
    yield from saturate(setup, settle)
    yield from settle_at(setup, levels[:1], "base", settle)
    for k in range(1, len(levels)):
        yield from settle_at(setup, [levels[k]], f"rise {k}", settle)
        yield from settle_at(setup, reversed(levels[:k]), f"fod {k}", settle)
