"""A loop as a small drawing: the path of an SVG in a box of 100 × 66."""

from collections.abc import Sequence

WIDTH, HEIGHT, MARGIN = 100.0, 66.0, 2.0


def loop_path(u: Sequence[float], y: Sequence[float]) -> str:
    """The path through (u, y), input to the right and output upwards; "" if there is nothing to draw.

    >>> loop_path([0, 1], [0, 2])
    'M2.0 64.0L98.0 2.0'
    """
    if len(u) < 2 or max(u) == min(u) or max(y) == min(y):
        return ""
    across = (WIDTH - 2 * MARGIN) / (max(u) - min(u))
    up = (HEIGHT - 2 * MARGIN) / (max(y) - min(y))
    left, bottom = min(u), min(y)
    points = (
        f"{MARGIN + (a - left) * across:.1f} {HEIGHT - MARGIN - (b - bottom) * up:.1f}" for a, b in zip(u, y)
    )
    return "M" + "L".join(points)
