"""The run that would separate what is left: each explanation imagines each run, and all explain what it imagines.

    T(run) = min over truths i, rivals j of  log p(record + imagined by i | i) − log p(record + imagined by i | j)

Both densities and both strengths are fitted again to the record with the imagined run (the T-criterion of Atkinson
and Fedorov 1975, with everything else free), so T is what the next diagnosis may expect to be ahead by. The quickest
run that settles it is proposed, else the one that gains most per hour. Knows no rig but through previews and twins.
"""

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import exp
from pathlib import Path
from typing import Any

from smarig.config import load_rig
from smarig.diagnosis.density_beside import density_beside
from smarig.diagnosis.diagnose import Diagnosis
from smarig.diagnosis.explanation import Explanation
from smarig.diagnosis.refine import refined
from smarig.diagnosis.refit import Refit
from smarig.diagnosis.verdict import TEMPERATURE
from smarig.errors import SmarigError, UsageError
from smarig.record import load_run
from smarig.runner.preview import preview
from smarig.simulation import simulate_protocol
from smarig.story.told import Story, told
from smarig.whole_file import whole_file

SURE = 12.0  # nats ahead: the odds of being wrong are then a twentieth, even tempered
VAIN = 1.0  # nats: a run that tells less is not worth its hours
RIVALS = 3  # explanations that compete
UNLIKELY = 1e-3  # probability: what is less likely is told apart already
MENU: tuple[tuple[str, dict[str, Any]], ...] = (
    ("wiping_out", {}),
    ("congruency", {}),
    ("step_currents", {"profile": "decaying"}),
    ("step_currents", {"profile": "staircase", "settle.window_s": 250.0, "points": 16}),
    ("first_order_descending", {}),
)


@dataclass(frozen=True)
class Option:
    """A run that could be done: its cost, and by how many nats it would tell the likeliest explanations apart."""

    protocol: str
    settings: dict[str, Any]
    hours: float
    nats: float

    def sentence(self) -> str:
        """For a person."""
        worth = (
            f"would name the right one with probability {self.odds:.2f}"
            if self.nats >= VAIN
            else "would tell nothing"
        )
        return f"{self.protocol}{_said(self.settings)}, {self.hours:.1f} h on the rig: {worth}"

    @property
    def odds(self) -> float:
        """Probability that the right one is named after it."""
        return 1 / (1 + exp(-self.nats / TEMPERATURE))

    def to_json(self) -> dict[str, Any]:
        """For the CLI."""
        return {
            "protocol": self.protocol,
            "settings": self.settings,
            "rig_hours": self.hours,
            "expected_nats": self.nats,
        }


@dataclass(frozen=True)
class Proposal:
    """The option to do next, all options, and the explanations it would separate."""

    best: Option
    options: tuple[Option, ...]
    rivals: tuple[tuple[str, ...], ...]

    def sentence(self) -> str:
        """For a person."""
        names = " or ".join(" + ".join(names) for names in self.rivals)
        b = self.best
        return (
            f"To tell {names}: {b.protocol}{_said(b.settings)}, {b.hours:.1f} h on the rig; "
            f"the right one should then be {b.nats:.0f} nats ahead (odds {b.odds:.2f})."
        )

    def to_json(self) -> dict[str, Any]:
        """For the CLI."""
        return self.best.to_json() | {
            "odds": self.best.odds,
            "rivals": [list(names) for names in self.rivals],
            "options": [o.to_json() for o in self.options],
            "why": self.sentence(),
        }

    def campaign(self) -> str:
        """A campaign file of the best option."""
        b = self.best
        settings = ", ".join(f'"{k}" = {_toml(v)}' for k, v in b.settings.items())
        return (
            f"# {self.sentence()}\n"
            'name = "separating"\n'
            f'summary = "Tells {" or ".join(" + ".join(n) for n in self.rivals)} apart."\n\n'
            "[[step]]\n"
            f'protocol = "{b.protocol}"\n'
            'purpose = "train"\n' + (f"set = {{ {settings} }}\n" if settings else "")
        )


def proposed(found: Diagnosis, progress: Callable[[str], None] | None = None) -> Proposal | None:
    """The next run for a diagnosis, on its model's rig; None where nothing is left to be told apart, or no run would.

    Raises UsageError when the model names no rig that runs could be imagined on.
    """
    if not found.model.rig:
        raise UsageError(f"Model '{found.model.name}' names no rig, so no run can be imagined on it.")
    rivals, say = _rivals(found), progress or (lambda _: None)
    if len(rivals) < 2:
        say("Nothing is left to be told apart.")
        return None
    rig = load_rig(found.model.rig)
    options = []
    with tempfile.TemporaryDirectory() as folder:
        for k, (protocol, settings) in enumerate(MENU):
            try:
                cost = preview(protocol, rig, settings)
                nats = _separated(found, rivals, protocol, settings, Path(folder) / f"{k}")
            except SmarigError:  # a rig that cannot do it
                continue
            options.append(Option(protocol, settings, cost.duration_s / 3600, nats))
            say(f"imagined {k + 1} of {len(MENU)}: {options[-1].sentence()}")
    if max((o.nats for o in options), default=0.0) < VAIN:
        say(
            f"No run that this rig can do would tell {' or '.join(' + '.join(e.names) for e in rivals)} apart."
        )
        return None
    return Proposal(_best(options), tuple(options), tuple(e.names for e in rivals))


def write_campaign(proposal: Proposal, path: Path, *, force: bool = False) -> None:
    """The campaign file. UsageError when it exists, without ``force``."""
    with whole_file(path, force=force) as part:
        part.write_text(proposal.campaign(), encoding="utf-8")


def _best(options: Sequence[Option]) -> Option:
    settling = [o for o in options if o.nats >= SURE]
    if settling:
        return min(settling, key=lambda o: o.hours)
    return max(options, key=lambda o: o.nats / o.hours)


def _rivals(found: Diagnosis) -> list[Explanation]:
    """The likeliest explanations of different causes, of those that are likely at all."""
    if not found.levels:
        return []
    likely = {names for names, p in found.verdict.explanations if p >= UNLIKELY}
    distinct: dict[tuple[str, ...], Explanation] = {}
    for explanation in found.levels[-1].explanations:
        if explanation.names in likely:
            distinct.setdefault(explanation.names, explanation)
    return list(distinct.values())[:RIVALS]


def _separated(
    found: Diagnosis,
    rivals: Sequence[Explanation],
    protocol: str,
    settings: dict[str, Any],
    folder: Path,
) -> float:
    """By how many nats the truth would be ahead, whichever of the first two it is."""
    leads = []
    for k, truth in enumerate(rivals[:2]):
        model = replace(
            found.model,
            name=f"imagined {k}",
            hysteresis=truth.subject.hysteresis,
            effects=tuple(e.to_json() for e in truth.subject.planted),
        )
        folder.mkdir(exist_ok=True)
        run = load_run(simulate_protocol(model, protocol, settings, folder / f"{k}.run.sqlite"))
        story = told([*found.story.runs, run], truth.subject.actuator.tau_s)
        like = found.levels[-1].critique.refitted
        worth = [_evidence(story, explanation, like) for explanation in rivals]
        leads.append(min(worth[k] - other for j, other in enumerate(worth) if j != k))
    return min(leads)


def _evidence(story: Story, explanation: Explanation, like: Refit) -> float:
    """Log likelihood of the record with an imagined run, strengths and density fitted again."""
    subject, refitted = density_beside(story, explanation.subject, like)
    fine = refined(subject.planted, story, subject, refitted, subject.hysteresis)
    return density_beside(story, fine.extended, refitted)[1].log_evidence


def _said(settings: dict[str, Any]) -> str:
    return f" ({', '.join(f'{k} = {v}' for k, v in settings.items())})" if settings else ""


def _toml(value: Any) -> str:
    return f'"{value}"' if isinstance(value, str) else str(value)
