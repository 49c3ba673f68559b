"""Colours of the live view, with the same meanings as in the reports (after Okabe and Ito).

The planes have a dark ground in every theme. Time series must be readable on black and on white. Lighter
colours replace the reports' ink and deep blue, which are invisible on black.
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
AMBER: Colour = (247, 201, 72)  # label of the twin

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
    """Colour of a wire between ambient and its highest temperature: blue, pale yellow, vermilion."""
    if share < 0.5:
        return blend(SKY, PALE, 2 * share)
    return blend(PALE, VERMILION, 2 * share - 1)


def model_colour(k: int) -> Colour:
    """Colour of the k-th model."""
    return MODELS[k % len(MODELS)]
