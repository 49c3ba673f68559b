"""The evidence of a characterisation that stands in a folder, computed again from its runs."""

import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from pydantic import ValidationError

from smarig.app.characterise import analyse
from smarig.config import CampaignFile, RigFile, load_campaign, load_rig, shipped_names
from smarig.core import DataError, Origin, Source, UsageError
from smarig.record import Run, load_run
from smarig.report import Evidence

PAGE_FILE, MODEL_FILE, RUNS_FOLDER = "report.html", "model.json", "runs"


def is_characterisation(folder: Path) -> bool:
    """Whether ``smarig characterise`` wrote a folder to its end."""
    return all((folder / name).exists() for name in (PAGE_FILE, MODEL_FILE, RUNS_FOLDER))


def characterised_folder(folder: Path, progress: Callable[[str], None] = lambda _: None) -> Evidence:
    """The evidence of a characterisation; nothing is written.

    Raises UsageError if the folder holds none or its campaign is not one that ships, and what reading its runs and its
    rig file raises.
    """
    if not is_characterisation(folder):
        raise UsageError(f"{folder} holds no characterisation ({PAGE_FILE}, {MODEL_FILE}, {RUNS_FOLDER}/).")
    plan = _campaign(folder)
    started = time.monotonic()
    runs = {step.label: load_run(file) for step, file in zip(plan.step, plan.run_files(folder / RUNS_FOLDER))}
    first = next(iter(runs.values()))
    rig, options = _recorded_arguments(first)
    return analyse(
        rig=rig,
        file=_recorded_rig(first, rig),
        out=folder,
        options=options,
        plan=plan,
        runs=runs,
        started=started,
        progress=progress,
    )


def _campaign(folder: Path) -> CampaignFile:
    """The campaign whose steps are the runs of the folder."""
    present = {file.name for file in (folder / RUNS_FOLDER).glob("*.run.sqlite")}
    for name in shipped_names("campaigns"):
        plan = load_campaign(name)
        if {file.name for file in plan.run_files(folder / RUNS_FOLDER)} == present:
            return plan
    raise UsageError(
        f"The runs in {folder / RUNS_FOLDER} are not those of the campaigns {', '.join(shipped_names('campaigns'))}. "
        "Name one of its run files."
    )


def _recorded_rig(run: Run, rig: str) -> RigFile:
    """The rig with the values of the record, so that no file is read that a record names; else that of smarig."""
    if run.info.rig_values:
        with suppress(ValidationError):  # of another version
            return RigFile.model_validate(run.info.rig_values, context=Source(run.path.name, Origin.INSIDE))
    return load_rig(rig)


def _recorded_arguments(run: Run) -> tuple[str, str]:
    """The rig file of a run, and the options of the command as text."""
    given = run.info.launch_args or {}
    rig = given.get("rig") or run.info.rig
    if not rig:
        raise DataError(f"{run.path} does not name its rig, which the analysis needs.")
    effects = given.get("effects")
    pairs = [f" --effect {pair}" for pair in effects] if isinstance(effects, list) else []
    return rig, "".join(pairs) + f" --seed {run.info.seed or 0}"
