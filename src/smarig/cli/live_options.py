"""The options of the live view (``--live``, ``--web``, ``--live-model``), shared by all commands that run
something."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from smarig.cli.option_group import option_group
from smarig.cli.output import json_requested, show_message
from smarig.cli.parameter_types import FILE
from smarig.core import Sample, StepResult, UsageError

if TYPE_CHECKING:
    from smarig.config import RigFile
    from smarig.preisach import Everett
    from smarig.replay import NamedPredictor
    from smarig.runner import Listener


class LiveOptions(NamedTuple):
    """The values of the live options."""

    wanted: bool
    web: bool
    models: tuple[Path, ...]


def _live(live: bool, web: bool, live_model: tuple[Path, ...]) -> LiveOptions:
    return LiveOptions(live or web or bool(live_model), web, live_model)


live_options = option_group(
    "live",
    _live,
    (
        click.option("--live", is_flag=True, help="Open the live view (extra 'live')."),
        click.option("--web", is_flag=True, help="Live view in a browser, on this machine only."),
        click.option(
            "--live-model",
            multiple=True,
            type=FILE,
            help="Live view: a model whose predictions are shown; repeatable.",
        ),
    ),
)


@contextmanager
def live_view(
    live: LiveOptions,
    rig: "RigFile",
    source: str,
    settings: Mapping[str, Any],
    title: str,
    *,
    resumed: bool = False,
) -> "Iterator[list[Listener]]":
    """Yield the live view's listeners: one, or none without a live option.

    ``resumed``: the wire already has a history, so its state is unknown to the view.
    """
    if not live.wanted:
        yield []
        return
    from smarig.live import live_listener, rig_display_info
    from smarig.plant import Actuator

    actuator = Actuator.named(rig.actuator)
    display_info = rig_display_info(rig, actuator, source, settings, title, known=not resumed)
    predictions, hysteresis = _live_predictions(live.models, rig, actuator)
    wait_at_end = sys.stderr.isatty() and not json_requested()
    with live_listener(
        display_info,
        predictions,
        hysteresis,
        web=live.web,
        wait_at_end=wait_at_end,
        show_message=show_message,
    ) as watcher:
        yield [watcher]


def _live_predictions(
    paths: Sequence[Path], rig: "RigFile", actuator: Any
) -> "tuple[list[NamedPredictor], Everett | None]":
    from smarig.plant import effects_from_json
    from smarig.replay import HysteresisPredictor, NamedPredictor, PlantPredictor, load_model

    found, initial = [], actuator.file.hysteresis.initial
    models = [(legend_name(path), load_model(path)) for path in paths]
    for name, model in models:
        if model.unit != actuator.unit:
            raise UsageError(f"Model {name} is in {model.unit}, but the rig measures in {actuator.unit}.")
        effects = effects_from_json(model.effects)
        predictor = (
            PlantPredictor(actuator, model.hysteresis, initial, rig.period_s, effects)
            if effects
            else HysteresisPredictor(model.hysteresis, initial)
        )
        found.append(NamedPredictor(name, predictor))
    return found, models[0][1].hysteresis if models else None


def legend_name(path: Path) -> str:
    """The name of a model file in a legend."""
    return path.name.removesuffix(".json").removesuffix(".model")


@contextmanager
def with_watchers(
    live_listener: "AbstractContextManager[Listener]", watchers: "Sequence[Listener]"
) -> "Iterator[Listener]":
    """Yield the listener together with those of the live view."""
    with live_listener as listener:
        yield ListenerGroup([listener, *watchers]) if watchers else listener


class ListenerGroup:
    """Several listeners as one."""

    def __init__(self, listeners: "Sequence[Listener]") -> None:
        self._listeners = listeners

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Pass the sample to each listener."""
        for listener in self._listeners:
            listener.sample(s, step, input_value)

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Pass the finished step to each listener."""
        for listener in self._listeners:
            listener.step(result, branch=branch, target=target)

    def begin(self, *what: Any) -> None:
        """Pass the start of a step to each listener that accepts it."""
        from smarig.runner import StepStartListener

        for listener in self._listeners:
            if isinstance(listener, StepStartListener):
                listener.begin(*what)

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Pass the event to each listener."""
        for listener in self._listeners:
            listener.event(t_s, kind, text, level=level, **data)
