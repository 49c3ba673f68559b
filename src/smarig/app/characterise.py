"""Characterise a wire: run the campaign, test, identify, verify, diagnose and report, as in chapter 5 of the
thesis."""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.app.characterisation_runs import (
    DIAGNOSIS,
    ListenerFactory,
    campaign_plan,
    check_folder,
    run_campaign,
)
from smarig.config import CampaignFile, RigFile, load_rig
from smarig.core import DataError, UsageError
from smarig.diagnosis import DIAGNOSIS_PAGE, CommandedDiagnosis, diagnose_commanded, write_diagnosis
from smarig.identification import (
    POSITIVE_KIND,
    Identification,
    Representation,
    SurfaceChoice,
    calibrate,
    congruency,
    identify,
    surface_kinds,
    verify,
    wiping_out,
)
from smarig.plant import Actuator, effects_from_arguments
from smarig.record import Run
from smarig.replay import Model, recorded_actuator
from smarig.report import (
    Evidence,
    ExtensionEvidence,
    against_preisach,
    assessment,
    characterisation_page,
    characterisation_summary,
    diagnosis_page,
    preisach_verdict,
    tag,
    titled,
    write_page,
)
from smarig.rig import TwinSettings
from smarig.runner import (
    RunControl,
    initialisation_spread,
)


@dataclass(frozen=True)
class Characterisation:
    """The results of ``smarig characterise`` and the paths of its files."""

    out: Path
    evidence: Evidence

    def _repr_html_(self) -> str:
        """The sentences of the first screen of the page, for notebooks."""
        return assessment(self.evidence).html() + tag("p", f"Page: {self.out / 'report.html'}")

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command."""
        e = self.evidence
        chosen = e.identifications[e.chosen]
        return {
            "out": str(self.out),
            "report": str(self.out / "report.html"),
            "model": str(self.out / "model.json"),
            "runs": [str(run.path) for run in e.runs.values()],
            "surface": e.chosen,
            "identify": chosen.to_json(),
            "verify": {name: v.to_json() for name, v in e.verifications.items()},
            "representation": [r.to_json() for r in e.representation],
            "preisach": preisach_verdict(e).to_json(),
            "diagnose": e.diagnosis.to_json() | {"out": str(self.out / DIAGNOSIS)} if e.diagnosis else None,
            "discoveries": list(e.discoveries),
            "warnings": list(e.warnings),
            "seconds": e.seconds,
        }


def characterise(
    rig: str,
    out: Path,
    *,
    campaign: str = "characterise",
    effects: Sequence[str] = (),
    seed: int = 0,
    wire: str = "",
    force: bool = False,
    go_on: bool = False,
    control: RunControl | None = None,
    listener_factory: ListenerFactory | None = None,
    progress: Callable[[str], None] | None = None,
) -> Characterisation:
    """Characterise the wire of a rig into a folder: runs, model.json, report.html, summary.html.

    ``effects`` of a twin are written as on the command line, "walking=0.3".
    Nothing existing is overwritten without ``force``. With ``go_on``, finished runs are kept and an
    interrupted run is resumed. Raises what the runs raise; a finished run is kept.
    """
    started = time.monotonic()
    plan = campaign_plan(campaign)
    if force and go_on:
        raise UsageError("--force replaces runs and --continue continues them. Give only one of them.")
    check_folder(out, plan, force, go_on)
    runs = run_campaign(
        rig=rig,
        plan=plan,
        out=out,
        twin=TwinSettings(seed=seed, effects=effects_from_arguments(tuple(effects))),
        wire=wire,
        force=force,
        control=control,
        listener_factory=listener_factory or (lambda *_: nullcontext()),
    )
    evidence = analyse(
        rig=rig,
        file=load_rig(rig),
        out=out,
        options="".join(f" --effect {effect}" for effect in effects)
        + (f" --wire {wire}" if wire else "")
        + f" --seed {seed}",
        plan=plan,
        runs=runs,
        started=started,
        progress=progress or (lambda _: None),
    )
    evidence.identifications[evidence.chosen].model.save(out / "model.json", force=force)
    if evidence.diagnosis is not None:
        write_diagnosis(evidence.diagnosis, out / DIAGNOSIS, force=force)
        write_page(diagnosis_page(evidence.diagnosis), out / DIAGNOSIS / DIAGNOSIS_PAGE, force=force)
    write_page(characterisation_page(evidence), out / "report.html", force=force)
    write_page(characterisation_summary(evidence), out / "summary.html", force=force)
    return Characterisation(out, evidence)


def analyse(
    rig: str,
    file: RigFile,
    out: Path,
    options: str,
    plan: CampaignFile,
    runs: Mapping[str, Run],
    started: float,
    progress: Callable[[str], None],
) -> Evidence:
    """The evidence of the runs of a campaign on the rig ``file``.

    ``rig``, ``out`` and ``options`` are those of the command, as text.
    """
    train, held_out = _runs_for(plan, runs, "train"), _runs_for(plan, runs, "held_out")
    results, identification_warnings = _identify_all(train)
    verified = {name: verify(result.model, held_out) for name, result in results.items()} if held_out else {}
    chosen, choice = _choose_surface(train, results)
    actuator = _actuator(runs, file)
    diagnosis, diagnosis_warnings = _try_diagnosis(results[chosen].model, plan, runs, progress)
    representation = _representation(runs)
    extension = None
    if held_out and against_preisach(representation, diagnosis):
        progress("extensions of the operator")
        extension = _try_extensions([run for run in runs.values() if run not in held_out], held_out)
    return Evidence(
        title=titled("Characterisation", list(runs.values())),
        runs=runs,
        representation=representation,
        identifications=results,
        chosen=chosen,
        verifications=verified,
        calibration=calibrate(list(runs.values()), actuator, results[chosen].model.hysteresis),
        discoveries=_discoveries(file, actuator),
        warnings=tuple(
            dict.fromkeys(
                [
                    *_twin_warnings(runs, hidden=file.hidden_effect),
                    *identification_warnings,
                    *diagnosis_warnings,
                    *results[chosen].warnings,
                    *_unsettled_warnings(runs),
                ]
            )
        ),
        command=f"smarig characterise --rig {rig} --out {out}{options}",
        seconds=time.monotonic() - started,
        choice=choice,
        diagnosis=diagnosis,
        extension=extension,
    )


def _try_extensions(runs: list[Run], held_out: list[Run]) -> ExtensionEvidence | None:
    """The best extension of a positive measure of all these runs, or None if they do not determine any."""
    settled = [run for run in runs if run.settled]
    try:
        best = identify(settled, surface=POSITIVE_KIND, extension="best")
    except DataError:
        return None
    if best.extension is None:
        return None
    if not best.extension.values:  # the classical model is the best
        return ExtensionEvidence(best.extension, verify(best.model, held_out), None)
    classical = identify(settled, surface=POSITIVE_KIND)
    return ExtensionEvidence(best.extension, verify(classical.model, held_out), verify(best.model, held_out))


def _try_diagnosis(
    model: Model, plan: CampaignFile, runs: Mapping[str, Run], progress: Callable[[str], None]
) -> tuple[CommandedDiagnosis | None, list[str]]:
    """The diagnosis trained on all runs except the held-out ones, or None with the reason why there is none."""
    held_out_runs = _runs_for(plan, runs, "held_out")
    train_runs = [run for run in runs.values() if run not in held_out_runs and run.settled]
    if not train_runs:
        return None, [
            "No diagnosis: it needs settled positions, and no run but held-out ones has any. Add a step with holds, "
            "such as minor_loops."
        ]
    try:
        return diagnose_commanded(model, train_runs, held_out_runs, progress=progress), []
    except DataError as error:
        return None, [f"No diagnosis: {error}"]


def _runs_for(plan: CampaignFile, runs: Mapping[str, Run], purpose: str) -> list[Run]:
    return [runs[s.label] for s in plan.step if s.purpose == purpose]


def _identify_all(train: list[Run]) -> tuple[dict[str, Identification], list[str]]:
    results: dict[str, Identification] = {}
    identification_warnings: list[str] = []
    for name in surface_kinds():
        try:
            results[name] = identify(train, surface=name)
        except DataError as error:
            identification_warnings.append(f"No {name} model: {error}")
    if not results:
        raise DataError("No model could be identified. " + " ".join(identification_warnings))
    return results, identification_warnings


def _choose_surface(
    train: list[Run], results: Mapping[str, Identification]
) -> tuple[str, SurfaceChoice | None]:
    """The best surface by held-out curves of the training data. The validation run is used for evaluation
    only."""
    try:
        best = identify(train, surface="best")
    except DataError:  # too few curves to hold any out
        return min(results, key=lambda name: results[name].model.fit["rms"]), None
    return best.surface, best.choice


def _representation(runs: Mapping[str, Run]) -> tuple[Representation, ...]:
    tests = {"wiping_out": wiping_out, "congruency": congruency}
    return tuple(tests[name](run) for name, run in runs.items() if name in tests)


def _actuator(runs: Mapping[str, Run], file: RigFile) -> Actuator:
    """The actuator as recorded; else that of the rig file."""
    return recorded_actuator(next(iter(runs.values()))) or Actuator.named(file.actuator)


def _discoveries(rig: RigFile, actuator: Actuator) -> tuple[str, ...]:
    """Fig. 5.4 on the rig's own twin: only the differential rig has remnant hysteresis when cold."""
    if not actuator.two_wire:
        return ()
    return tuple(
        initialisation_spread(rig, actuator, method).sentence() for method in ("none", "thesis", "planned")
    )


def _surface_warning(name: str, injected: Sequence[str]) -> str:
    """On a surface of Table 5.1, or on the model of an actuator file ("")."""
    hysteresis = f"the surface {name} of Table 5.1" if name else "that of an identified model"
    if injected:
        return (
            f"This twin's hysteresis is {hysteresis}, with the injected effects {', '.join(injected)}. A Preisach "
            "model alone need not fit it."
        )
    best = ", best with this surface" if name else ""
    return (
        f"This twin's hysteresis is {hysteresis}, so a Preisach model fits it by construction{best}. It shows that the "
        "software works, not that a wire is a Preisach system."
    )


def _twin_warnings(runs: Mapping[str, Run], *, hidden: bool) -> list[str]:
    """Warnings for twins: most are Preisach models themselves, so that a good fit proves nothing about a wire."""
    recorded = [recorded_actuator(run) for run in runs.values() if run.twin]
    actuators = [a.file for a in recorded if a is not None]
    names = {a.hysteresis.surface or "" for a in actuators if a.thermomechanical is None}
    thermomechanical = sorted({a.name for a in actuators if a.thermomechanical is not None})
    if hidden:
        return [
            "An effect may be hidden in this twin. Until it is found, the best-fitting surface means little."
        ]
    injected = sorted({effect.partition("(")[0] for run in runs.values() for effect in run.info.effects})
    return [_surface_warning(name, injected) for name in sorted(names)] + [
        f"The wire of this twin ({name}) follows Brinson's constitutive model with a heat balance. It is no Preisach "
        "operator, so no surface is the true one."
        for name in thermomechanical
    ]


def _unsettled_warnings(runs: Mapping[str, Run]) -> list[str]:
    return [
        f"{name}: {late} of {len(run.steps)} steps did not settle in time and are marked."
        for name, run in runs.items()
        if (late := sum(s.verdict == "timed_out" for s in run.steps))
    ]
