"""The figure on diagnosis: residuals of twins with a known effect."""

import numpy as np

from figures.canvas import Panel, Picture
from figures.memory import WIRE
from smarig import Preisach
from smarig.config import load_rig
from smarig.core import Hold, Protocol, StepResult
from smarig.plant import Actuator, effects_from_pairs
from smarig.protocols import Setup, first_order_descending, validation
from smarig.rig import Guard, Twin, TwinSettings
from smarig.runner import CallbackListener, Runner

STEEP, FLAT = 0.05, 0.005  # mm/K
SHOWN = (
    ("walking=0.4", "walking, 0.4 % per cycle"),
    ("ambient_drift=1", "ambient drift, ± 1 K"),
    ("settling=3", "settling, 3 %"),
)


def signatures() -> Picture:
    """Residuals of three twins against time: the same experiment with three effects."""
    picture = Picture(
        740,
        316,
        "Residuals against time: walking shifts all points, ambient drift only those with a steep slope.",
    )
    for k, (effect, title) in enumerate(SHOWN):
        t, residual, slope = _residuals(effect)
        panel = Panel(
            picture, (58 + 234 * k, 34, 206, 214), (0, 1.7), (-0.3, 0.65),
            titles=(title, "time (h)", "measured − model (mm)" if k == 0 else ""),
            ticks=((0, 0.5, 1, 1.5), (-0.2, 0, 0.2, 0.4, 0.6) if k == 0 else ()),
        )  # fmt: skip
        panel.line([0, 1.7], [0, 0], "thin s-faint")
        for chosen, look in ((slope >= STEEP, "f-heat"), (slope <= FLAT, "f-cool")):
            panel.dots(t[chosen], residual[chosen], look, 2.6)
        rest = (slope > FLAT) & (slope < STEEP)
        panel.dots(t[rest], residual[rest], "f-grey", 1.6)
    looks = (
        (f"steep slope, ≥ {STEEP:g} mm/K", "f-heat"),
        (f"flat slope, ≤ {FLAT:g} mm/K", "f-cool"),
        ("between", "f-grey"),
    )
    for k, (words, look) in enumerate(looks):
        picture.add(f'<circle cx="{64 + 210 * k}" cy="302" r="3.5" class="{look}"/>')
        picture.add_text(74 + 210 * k, 306, words, "small f-ink")
    return picture


def _residuals(effect: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time (h), residual (mm) and slope (mm/K) of a twin's settled points, relative to the twin without the effect."""
    file = load_rig("one_wire_twin")
    actuator = Actuator.named(file.actuator)
    twin = Twin(file, actuator, TwinSettings(seed=1, effects=effects_from_pairs([effect])))
    ends: list[StepResult] = []
    runner = Runner(
        Guard(twin, file.limits, actuator),
        twin.position_per_count,
        [CallbackListener(lambda *_: None, ends.append)],
    )
    setup = Setup(actuator, file.limits, file.period_s)
    inputs_K: list[float] = []
    for protocol in (first_order_descending(setup), validation(setup, points=20)):
        runner.run(_record_inputs(protocol, inputs_K, actuator))
    wire, slopes, outputs = Preisach(WIRE), [], []
    for u in inputs_K:
        outputs.append(wire.step(u))
        ends_K = np.clip([u - 0.5, u + 0.5], 0, WIRE.upper)
        slopes.append(abs(wire.peek(ends_K[1]) - wire.peek(ends_K[0])) / (ends_K[1] - ends_K[0]))
    y = np.array([e.position for e in ends])
    return np.array([e.t_end_s for e in ends]) / 3600, y - np.array(outputs), np.array(slopes)


def _record_inputs(protocol: Protocol, inputs_K: list[float], actuator: Actuator) -> Protocol:
    """The protocol, wrapped to record the steady inputs of its holds."""
    answer = None
    while True:
        try:
            command = protocol.send(answer)
        except StopIteration:
            return
        if isinstance(command, Hold):
            inputs_K.append(actuator.input_for(command.current_A))
        answer = yield command
