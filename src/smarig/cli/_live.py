"""``--live``: a run watched while it happens. Options shared by the commands that run something."""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from smarig.cli._output import json_wanted, say
from smarig.cli._types import FILE
from smarig.command import StepResult
from smarig.errors import UsageError
from smarig.runner.listener import Beginnings
from smarig.sample import Sample

if TYPE_CHECKING:
    from smarig.config import RigFile
    from smarig.live.predicted import Prediction
    from smarig.preisach.everett import Everett
    from smarig.runner.listener import Listener


class Live(NamedTuple):
    """What was asked for."""

    wanted: bool
    web: bool
    models: tuple[Path, ...]


def live_options(command: Callable) -> Callable:
    """``--live``, ``--web`` and ``--live-model``, gathered into one argument ``live``."""

    def gathered(*args: Any, live: bool, web: bool, live_model: tuple[Path, ...], **rest: Any) -> Any:
        return command(*args, live=Live(live or web or bool(live_model), web, live_model), **rest)

    gathered.__doc__, gathered.__name__ = command.__doc__, command.__name__
    gathered.__click_params__ = getattr(command, "__click_params__", [])  # type: ignore[attr-defined]
    for option in (
        click.option(
            "--live-model", multiple=True, type=FILE, help="Live view: a model that predicts; repeatable."
        ),
        click.option("--web", is_flag=True, help="Live view in a browser, on this machine only."),
        click.option("--live", is_flag=True, help="Watch it live (extra 'live')."),
    ):
        gathered = option(gathered)
    return gathered


@contextmanager
def live_view(
    live: Live, rig: "RigFile", source: str, settings: Mapping[str, Any], title: str, *, goes_on: bool = False
) -> "Iterator[list[Listener]]":
    """The listeners to add: one, or none where nobody wants to watch. ``goes_on``: the wire has a past."""
    if not live.wanted:
        yield []
        return
    from smarig.live.showing import shown
    from smarig.live.subject import of_rig
    from smarig.model.actuator import Actuator

    actuator = Actuator.named(rig.actuator)
    subject = of_rig(rig, actuator, source, settings, title, known=not goes_on)
    predictions, hysteresis = _models(live.models, rig, actuator)
    linger = sys.stderr.isatty() and not json_wanted()
    with shown(subject, predictions, hysteresis, web=live.web, linger=linger, say=say) as watcher:
        yield [watcher]


def _models(
    paths: Sequence[Path], rig: "RigFile", actuator: Any
) -> "tuple[list[Prediction], Everett | None]":
    from smarig.identification.model_file import load_model
    from smarig.live.predicted import Extended, Memory, Prediction
    from smarig.model.planted import from_json

    found, initial = [], actuator.file.hysteresis.initial
    models = [(named(path), load_model(path)) for path in paths]
    for name, model in models:
        if model.unit != actuator.unit:
            raise UsageError(f"Model {name} speaks in {model.unit}, the rig measures in {actuator.unit}.")
        effects = from_json(model.effects)
        follower = (
            Extended(actuator, model.hysteresis, initial, rig.period_s, effects)
            if effects
            else Memory(model.hysteresis, initial)
        )
        found.append(Prediction(name, follower))
    return found, models[0][1].hysteresis if models else None


def named(path: Path) -> str:
    """A model file's name for a legend."""
    return path.name.removesuffix(".json").removesuffix(".model")


@contextmanager
def joined(shown: "AbstractContextManager[Listener]", watchers: "Sequence[Listener]") -> "Iterator[Listener]":
    """A listener, and with it those who watch live."""
    with shown as listener:
        yield Several([listener, *watchers]) if watchers else listener


class Several:
    """Listeners as one."""

    def __init__(self, listeners: "Sequence[Listener]") -> None:
        self._listeners = listeners

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """To each."""
        for listener in self._listeners:
            listener.sample(s, step, input_value)

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """To each."""
        for listener in self._listeners:
            listener.step(result, branch=branch, target=target)

    def begin(self, *what: Any) -> None:
        """To each that asks for it."""
        for listener in self._listeners:
            if isinstance(listener, Beginnings):
                listener.begin(*what)

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """To each."""
        for listener in self._listeners:
            listener.event(t_s, kind, text, level=level, **data)
