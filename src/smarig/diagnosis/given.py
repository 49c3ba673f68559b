"""Where the input itself was measured: which plain variables may matter, and how noisy such data may be.

A rate changes how high and how wide a loop is, so its traces are smooth functions of log |du/dt| times: 1, the
output, the slope (felt), and the slope with the sign of du/dt (a wider loop). Knows no effect by name.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from smarig.preisach.sensitivity import sensitivities
from smarig.story.given import noise_of
from smarig.story.retelling import Retelling
from smarig.story.subject import Subject
from smarig.story.told import Story

Array = NDArray[np.float64]
SPEEDS = 1.5  # rates that differ less, as a factor, are one rate
LEAST, SURE = (
    1e-5,
    3e-3,
)  # of a range: sd of a noise at least, and what it may be however smooth the record is
FIRM = 0.01  # of the stroke: a density is fitted to nothing more firmly than that
LARGEST = 3.0  # times the scatter that a record shows: nothing larger is noise
NEAR = (0.5, 5.0, 50.0)  # readings over which input noise keeps


def bounds(story: Story, span: float, stroke: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Least and most of s₀ (strokes) and s_T (input units): what a record's own scatter allows.

    ``span``, ``stroke``: input and output range of the hysteresis.
    """
    outputs = [run["position"][np.isfinite(run["position"])] for run in story.runs]
    y = LARGEST * max(noise_of(v) for v in outputs) / stroke
    u = LARGEST * float(np.sqrt(np.mean(story.jitter**2))) / span
    return (LEAST, max(y, SURE)), (LEAST * span, max(u, SURE) * span)


def scatter(story: Story, told: Retelling, subject: Subject) -> Array:
    """What the input's own scatter does to each reading, by the local slope, output units (n,)."""
    slope = [s[-1] for s in sensitivities(subject.hysteresis, told.states)]
    return np.abs(np.array(slope)) * story.jitter


def trust(story: Story, told: Retelling, subject: Subject) -> Array:
    """Weights (n,) of readings in a fit of the density, 1/σ, the best known at 1; equal ones for zeros apart."""
    if np.ptp(story.zero) > 0:
        return np.ones(story.zero.size)
    sigma = np.hypot(scatter(story, told, subject), FIRM * subject.stroke)
    return sigma.min() / sigma


def correlations_s(story: Story) -> tuple[float, ...]:
    """Correlation times worth trying, on the story's own clock."""
    apart = float(np.median(np.diff(story.settled.t_s)))
    return tuple(k * apart for k in NEAR)


def variables(story: Story, base: Retelling) -> dict[str, Array]:
    """Variables (n,) of each reading; time only where there is a clock."""
    turned = np.concatenate([[0], np.cumsum(np.diff(story.block) != 0)])
    travel = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(base.values["settled"])))])
    timed = {"time": story.settled.t_s} if story.given == "clock" else {}
    return timed | {
        "cycle": travel,
        "level": base.values["settled"],
        "history": story.reversal,
        "reversals": turned.astype(float),
    }


def rate(story: Story, base: Retelling, added: float, felt: Array) -> Iterator[tuple[str, Array]]:
    """("rate", raw traces (n, 8)) where runs of a clock differ in their rate, else nothing.

    ``added`` is an output, ``felt`` (n,) what an input adds, as large as may be expected.
    """
    z = np.log(np.maximum(story.speed, 1e-12))
    if story.given != "clock" or np.ptp(z) < np.log(SPEEDS):
        return
    place = 2 * (z - z.min()) / np.ptp(z) - 1
    y = base.values["settled"]
    level = (y - y.mean()) / (np.std(y) or 1.0)
    sense = np.sign(np.diff(story.target_K, prepend=story.target_K[0]))
    shapes = (np.full(z.size, added), added * level, felt, felt * sense)
    waves = (place, (3 * place**2 - 1) / 2)
    yield "rate", np.column_stack([w * s for w in waves for s in shapes])
