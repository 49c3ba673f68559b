"""First-order ascending (FOA) curves, the mirror image of the FOD protocol (§4.2)."""

from smarig.core import Mark, Protocol, Settled
from smarig.protocols._building_blocks import checked_partition, default_partition, saturate, settle_at
from smarig.protocols._setup import Setup


def first_order_ascending(
    setup: Setup, *, partition_K: tuple[float, ...] = (), settle: Settled | None = None
) -> Protocol:
    """First-order ascending curves: from positive saturation, fall to β, then rise through the partition.

    A classical Preisach operator gives the same density from FOD and FOA data. Comparing both tests it.
    """
    settle = settle or Settled()
    levels = checked_partition(setup, partition_K or default_partition(setup))
    yield Mark("first-order ascending", {"partition_K": list(levels)})
    yield from saturate(setup, settle)
    yield from saturate(setup, settle, upper=True)
    for k in range(len(levels) - 2, -1, -1):
        yield from settle_at(setup, [levels[k]], f"fall {k}", settle)
        yield from settle_at(setup, levels[k + 1 :], f"foa {k}", settle)
