"""Colours of the live view, with the meanings they have in the reports (after Okabe & Ito).

The planes' ground is dark whatever theme a viewer has; graphs over time must be read on black and on white. The
reports' ink and deep blue vanish on black; their lighter kin stand in. Knows no data.
"""

Colour = tuple[int, int, int]

GROUND: Colour = (13, 16, 17)
INK: Colour = (225, 229, 234)
GREY: Colour = (128, 136, 146)
FAINT: Colour = (58, 64, 72)
SKY: Colour = (86, 180, 233)
VERMILION: Colour = (213, 94, 0)
ORANGE: Colour = (230, 159, 0)
GREEN: Colour = (0, 158, 115)
PURPLE: Colour = (204, 121, 167)
PALE: Colour = (247, 225, 130)
AMBER: Colour = (247, 201, 72)  # the twin's label

MEASURED, COMMANDED, TEMPERATURE = SKY, GREY, VERMILION
MODELS = (GREEN, PURPLE, ORANGE, GREY)
HEATING, COOLING = VERMILION, SKY
GOOD, BAD = GREEN, VERMILION


def blend(cold: Colour, hot: Colour, share: float) -> Colour:
    """A mixture of two colours, ``share`` of the second, clipped to 0…1.

    >>> blend((0, 0, 0), (200, 100, 50), 0.5)
    (100, 50, 25)
    """
    s = min(max(share, 0.0), 1.0)
    r, g, b = (round(c + s * (h - c)) for c, h in zip(cold, hot, strict=True))
    return r, g, b


def temperature_colour(share: float) -> Colour:
    """Of a wire between ambient and its hottest: blue, pale yellow, vermilion."""
    if share < 0.5:
        return blend(SKY, PALE, 2 * share)
    return blend(PALE, VERMILION, 2 * share - 1)


def model_colour(k: int) -> Colour:
    """Of the k-th model."""
    return MODELS[k % len(MODELS)]
