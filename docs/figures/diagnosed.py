"""Figures on diagnosis: residuals of twins with a known effect, similar effects, and alarms by size of the effect."""

import re
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.stats import beta
from threadpoolctl import threadpool_limits

from figures.canvas import Panel, Picture
from figures.memory import WIRE
from smarig import Preisach, identify, load_run
from smarig.config import load_rig
from smarig.core import Hold, Protocol, StepResult
from smarig.diagnosis import VisibilityTable, critique, visibility
from smarig.plant import Actuator, effect_types, effects_from_pairs
from smarig.protocols import Setup, first_order_descending, validation
from smarig.replay import actuator_for_run, build_timeline, plant_model_of
from smarig.rig import Guard, Twin, TwinSettings
from smarig.runner import CallbackListener, Runner, Session

CELL = 16  # pixels of an effect in the map
STEEP, FLAT = 0.05, 0.005  # mm/K
SHOWN = (
    ("walking=0.4", "walking, 0.4 % per cycle"),
    ("ambient_drift=1", "ambient drift, ± 1 K"),
    ("settling=3", "settling, 3 %"),
)
PAGE = Path(__file__).resolve().parents[1] / "explanation" / "diagnosis.md"


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


def similar_effects() -> Picture:
    """The visibility of each effect in one record, and the share of its evidence that others could explain."""
    effect_visibility, points = _record()
    order = np.argsort(-effect_visibility.delta, kind="stable")
    order = order[effect_visibility.delta[order] > 0]
    names = [effect_visibility.names[k] for k in order]
    side = CELL * len(names)
    picture = Picture(
        740,
        side + 180,
        "Visibility of the effects in one record, and their similarity.",
    )
    left = Panel(
        picture, (148, 34, 150, side), (-2, 2), (len(names), 0),
        titles=("δ at typical strength", "δ", ""), ticks=((), ()),
    )  # fmt: skip
    for power in (-1, 0, 1):
        left.line([power, power], [0, len(names)], "thin dash s-faint")
        left.add_text(power, len(names), f"{10.0**power:g}", "small middle f-ink", (0, 16))
    right = Panel(
        picture, (322, 34, side, side), (0, len(names)), (len(names), 0),
        titles=("share of a row's evidence that a column explains", "", ""), ticks=((), ()),
    )  # fmt: skip
    for k, j in enumerate(order):
        left.add_text(-2, k + 0.5, names[k], "small end f-ink", (-8, 4))
        end = float(np.clip(np.log10(effect_visibility.delta[j]), -2, 2))
        left.area([-2, end, end, -2], [k + 0.15, k + 0.15, k + 0.85, k + 0.85], "f-cool")
        for i, other in enumerate(order):
            _share(right, i, k, float(effect_visibility.imitated[j, other]))
        u, v = right.at(k + 0.5, len(names))
        turn = f'transform="translate({u + 4:.0f} {v + 8:.0f}) rotate(-90)"'
        picture.add(f'<text {turn} class="small end f-ink">{names[k]}</text>')
    picture.add_text(14, side + 84, f"n = {points} settled points and the readings", "small f-grey")
    picture.add_text(14, side + 100, "between them; twin without effects", "small f-grey")
    return picture


def _share(panel: Panel, x: int, y: int, share: float) -> None:
    u, v = panel.at(x, y)
    if share >= 0.05:
        box = f'x="{u + 0.5:g}" y="{v + 0.5:g}" width="{CELL - 1}" height="{CELL - 1}"'
        panel.picture.add(
            f'<rect {box} class="f-{"grey" if x == y else "heat"}" fill-opacity="{share:.2f}"/>'
        )


def _record() -> tuple[VisibilityTable, int]:
    """Visibility in reversal curves and a validation run of the twin without effects."""
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{name}.run.sqlite" for name in ("first_order_descending", "congruency")]
        with Session("one_wire_twin", seed=1, wire="figures") as session:
            for file in files:
                session.run(file.name.removesuffix(".run.sqlite"), {}, file)
        runs = [load_run(file) for file in files]
    model = identify(runs[0], surface="exponential").model
    timeline = build_timeline(runs, actuator_for_run(model, runs[0]).tau_s)
    with threadpool_limits(1, "blas"):
        effect_visibility = visibility(
            critique(timeline, plant_model_of(model, timeline.runs[0]), effect_types("one_wire"), count=40)
        )
    return effect_visibility, sum(len(run.settled) for run in runs)


def found_by_size() -> Picture:
    """Alarms on sealed boxes against the size δ of their effects, with the numbers on the page on diagnosis."""
    counts = list(_counts())
    picture = Picture(
        740, 322, "The share of sealed boxes with an alarm rises from 5 % to 95 % between δ = 0.2 and 1."
    )
    panel = Panel(
        picture, (58, 34, 640, 214), (0, len(counts)), (0, 1),
        titles=("alarms with exact 95 % intervals", "", "share of boxes"),
        ticks=((), (0, 0.25, 0.5, 0.75, 1)),
    )  # fmt: skip
    for k, (hits, of, words) in enumerate(counts):
        low = beta.ppf(0.025, hits, of - hits + 1) if hits else 0.0
        high = beta.ppf(0.975, hits + 1, of - hits) if hits < of else 1.0
        panel.area([k + 0.2, k + 0.8, k + 0.8, k + 0.2], [0, 0, hits / of, hits / of], "wash f-cool")
        panel.bars([k + 0.5], [float(low)], [float(high)], "s-cool")
        panel.dots([k + 0.5], [hits / of], "f-cool", 4)
        panel.add_text(k + 0.5, 0, words, "small middle f-ink", (0, 16))
        panel.add_text(k + 0.5, 0, f"{hits} of {of}", "small middle f-grey", (0, 32))
    picture.add_text(378, 308, "size δ: rms that no density explains, relative to the noise", "middle f-ink")
    return picture


def _counts() -> Iterator[tuple[int, int, str]]:
    """Alarms, boxes and range of δ, read from the page."""
    text = re.search(r"By size: (.*?)\.\n", PAGE.read_text(encoding="utf-8"))
    if text is None:
        raise ValueError("the page on diagnosis lacks the sentence 'By size: …' with alarms by size")
    last = "0"
    for part in text[1].split(", "):
        hits, of = map(int, re.findall(r"\b(\d+) of (\d+)", part)[0])
        end = re.search(r"(?:<|up to) ([\d.]+)", part)
        yield hits, of, f"{last} to {end[1]}" if end else f"beyond {last}"
        last = end[1] if end else last
