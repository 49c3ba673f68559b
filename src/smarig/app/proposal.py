"""Choice of the separating run: the run that best distinguishes the likely hypotheses of a diagnosis.

Each hypothesis simulates each candidate run, and all of them are fitted to the result:

    T(run) = min over truths i, rivals j of  log p(record + simulated by i | i) − log p(record + simulated by i | j)

Densities and strengths are fitted again to the record with the simulated run (the T-criterion of Atkinson
and Fedorov 1975, with everything else free). T is therefore the lead in evidence that the next diagnosis can
expect. The shortest run with a decisive lead is proposed, otherwise the run with the largest lead per hour.
"""

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import exp, log
from pathlib import Path
from typing import Any

from smarig.app.simulated_run import simulate_protocol
from smarig.config import load_rig
from smarig.core import SmarigError, UsageError, atomic_file
from smarig.diagnosis import (
    RULES,
    TEMPERATURE,
    CommandedDiagnosis,
    Refit,
    fit_parameters,
    joint_density,
)
from smarig.record import load_run
from smarig.replay import PlantModel, Timeline, build_timeline
from smarig.runner import preview

NAMED = RULES["name"].value
DECISIVE_NATS = TEMPERATURE * log(NAMED / (1 - NAMED))  # of lead: then the right hypothesis has a name
NEGLIGIBLE_NATS = 1.0  # nats: a run with less is not worth its hours
MAX_RIVALS = 3  # competing hypotheses
MIN_PROBABILITY = 1e-3  # less likely hypotheses are already excluded
PROTOCOL_OPTIONS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("wiping_out", {}),
    ("congruency", {}),
    ("step_currents", {"profile": "decaying"}),
    ("step_currents", {"profile": "staircase", "settle.window_s": 250.0, "points": 16}),
    ("first_order_descending", {}),
)


@dataclass(frozen=True, eq=False)
class Rival:
    """A hypothesis of effects that was fitted: their names, the plant model with them, and its refit."""

    names: tuple[str, ...]
    plant_model: PlantModel
    refitted: Refit


@dataclass(frozen=True)
class RunOption:
    """A possible run: its duration and the lead, in nats, of the right one after it."""

    protocol: str
    settings: dict[str, Any]
    hours: float
    nats: float

    def sentence(self) -> str:
        """The option in words."""
        evidences = (
            f"would name the right one with probability {self.odds:.2f}"
            if self.nats >= NEGLIGIBLE_NATS
            else "would distinguish nothing"
        )
        return f"{self.protocol}{_settings_text(self.settings)}, {self.hours:.1f} h on the rig: {evidences}"

    @property
    def odds(self) -> float:
        """Probability that the right one is named after the run."""
        return 1 / (1 + exp(-self.nats / TEMPERATURE))

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command."""
        return {
            "protocol": self.protocol,
            "settings": self.settings,
            "rig_hours": self.hours,
            "expected_nats": self.nats,
        }


@dataclass(frozen=True)
class Proposal:
    """The best run, all options, and the hypotheses that it would distinguish."""

    best: RunOption
    options: tuple[RunOption, ...]
    rivals: tuple[tuple[str, ...], ...]

    def sentence(self) -> str:
        """The proposal in words."""
        names = " or ".join(" + ".join(names) for names in self.rivals)
        b = self.best
        return (
            f"To distinguish {names}: {b.protocol}{_settings_text(b.settings)}, {b.hours:.1f} h on the rig. "
            f"The right one should then be named with probability {b.odds:.2f}."
        )

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command."""
        return self.best.to_json() | {
            "odds": self.best.odds,
            "rivals": [list(names) for names in self.rivals],
            "options": [o.to_json() for o in self.options],
            "why": self.sentence(),
        }

    def campaign(self) -> str:
        """The text of a campaign file with the best option."""
        b = self.best
        settings = ", ".join(f'"{k}" = {_toml(v)}' for k, v in b.settings.items())
        return (
            f"# {self.sentence()}\n"
            'name = "separating"\n'
            f'summary = "Distinguishes {" or ".join(" + ".join(n) for n in self.rivals)}."\n\n'
            "[[step]]\n"
            f'protocol = "{b.protocol}"\n'
            'purpose = "train"\n' + (f"set = {{ {settings} }}\n" if settings else "")
        )


def propose_run(result: CommandedDiagnosis, progress: Callable[[str], None] | None = None) -> Proposal | None:
    """The separating run for a diagnosis on its model's rig; None if nothing is left to distinguish or no
    run would do it.

    Raises UsageError if the model names no rig to simulate.
    """
    if not result.model.rig:
        raise UsageError(f"Model '{result.model.name}' names no rig, so no run can be simulated on it.")
    rivals, report_progress = _rivals(result), progress or (lambda _: None)
    if len(rivals) < 2:
        report_progress("Nothing is left to be distinguished.")
        return None
    rig = load_rig(result.model.rig)
    options = []
    with tempfile.TemporaryDirectory() as folder:
        for k, (protocol, settings) in enumerate(PROTOCOL_OPTIONS):
            try:
                cost = preview(protocol, rig, settings)
                nats = _separation_nats(result, rivals, protocol, settings, Path(folder) / f"{k}")
            except SmarigError:  # the rig cannot execute this run
                continue
            options.append(RunOption(protocol, settings, cost.duration_s / 3600, nats))
            report_progress(f"simulated {k + 1} of {len(PROTOCOL_OPTIONS)}: {options[-1].sentence()}")
    if max((o.nats for o in options), default=0.0) < NEGLIGIBLE_NATS:
        report_progress(
            f"No run on this rig would distinguish {' or '.join(' + '.join(e.names) for e in rivals)}."
        )
        return None
    return Proposal(_best(options), tuple(options), tuple(e.names for e in rivals))


def write_campaign(proposal: Proposal, path: Path, *, force: bool = False) -> None:
    """Write the campaign file. Raises UsageError if it exists, unless ``force``."""
    with atomic_file(path, force=force) as part:
        part.write_text(proposal.campaign(), encoding="utf-8")


def _best(options: Sequence[RunOption]) -> RunOption:
    settling = [o for o in options if o.nats >= DECISIVE_NATS]
    if settling:
        return min(settling, key=lambda o: o.hours)
    return max(options, key=lambda o: o.nats / o.hours)


def _rivals(result: CommandedDiagnosis) -> list[Rival]:
    """The heaviest hypotheses of effects that were fitted, without improbable ones."""
    models, weights = result.found.models, result.weights
    ranked = sorted(zip(weights.weight.tolist(), weights.hypotheses), key=lambda pair: -pair[0])
    likely = [h.parts for w, h in ranked if h.parts and h.parts in models and w >= MIN_PROBABILITY]
    of_effects = [parts for parts in likely if all(p.kind == "effect" for p in parts)][:MAX_RIVALS]
    return [
        Rival(tuple(p.name for p in parts), models[parts].plant_model, models[parts].refitted)
        for parts in of_effects
    ]


def _separation_nats(
    result: CommandedDiagnosis,
    rivals: Sequence[Rival],
    protocol: str,
    settings: dict[str, Any],
    folder: Path,
) -> float:
    """The lead, in nats, of the true hypothesis; the smaller one if either of the first two is true."""
    leads = []
    for k, truth in enumerate(rivals[:2]):
        model = replace(
            result.model,
            name=f"hypothesis {k}",
            hysteresis=truth.plant_model.hysteresis,
            effects=tuple(e.to_json() for e in truth.plant_model.catalogue_effects),
        )
        folder.mkdir(exist_ok=True)
        run = load_run(simulate_protocol(model, protocol, settings, folder / f"{k}.run.sqlite"))
        timeline = build_timeline([*result.timeline.runs, run], truth.plant_model.actuator.tau_s)
        evidences = [_evidence(timeline, rival) for rival in rivals]
        leads.append(min(evidences[k] - other for j, other in enumerate(evidences) if j != k))
    return min(leads)


def _evidence(timeline: Timeline, rival: Rival) -> float:
    """Log likelihood of the record with a simulated run, with strengths and density fitted again."""
    found = joint_density(timeline, rival.plant_model, rival.refitted)
    model = found.plant_model
    parameter_fit = fit_parameters(model.catalogue_effects, timeline, model, found.refitted, model.hysteresis)
    return joint_density(timeline, parameter_fit.extended, found.refitted).refitted.log_evidence


def _settings_text(settings: dict[str, Any]) -> str:
    return f" ({', '.join(f'{k} = {v}' for k, v in settings.items())})" if settings else ""


def _toml(value: Any) -> str:
    return f'"{value}"' if isinstance(value, str) else str(value)
