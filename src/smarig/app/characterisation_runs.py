"""The runs of a characterisation: the campaign, its previews, the folder that must be free, and the runs themselves."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

from smarig.config import CampaignFile, load_campaign, load_rig
from smarig.core import StorageError, UsageError
from smarig.diagnosis import DIAGNOSIS_JSON, DIAGNOSIS_PAGE
from smarig.diagnosis import DIAGNOSIS_MODEL as EXTENDED
from smarig.protocols import with_loaded_protocols
from smarig.record import Run, check_not_recording, load_run
from smarig.rig import TwinSettings
from smarig.runner import Listener, Preview, RunControl, Session, preview, run_or_resume

DIAGNOSIS = "diagnosis"  # name of its folder
ListenerFactory = Callable[[Preview, Path], AbstractContextManager[Listener | None]]  # of a run file


def campaign_previews(rig: str, campaign: str = "characterise") -> list[Preview]:
    """The previews of the runs of a characterisation, in order. Raises UsageError if it could not be started."""
    file = load_rig(rig)
    return [preview(step.protocol, file, step.set) for step in campaign_plan(campaign).step]


def campaign_plan(campaign: str) -> CampaignFile:
    """The campaign, with a step to identify from. Raises UsageError if it has none."""
    plan = with_loaded_protocols(load_campaign(campaign))
    if not any(step.purpose == "train" for step in plan.step):
        raise UsageError(
            f"Campaign '{plan.name}' has no step with purpose = \"train\". Add one to identify from."
        )
    return plan


def check_folder(out: Path, plan: CampaignFile, force: bool, go_on: bool) -> None:
    """Raise before anything moves if the folder cannot be written, or if something in it would be replaced."""
    try:
        (out / "runs").mkdir(parents=True, exist_ok=True)
        probe = out / ".writable"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise StorageError(f"Folder {out} cannot be written: {error.strerror or error}.") from None
    targets = [
        *([] if go_on else plan.run_files(out / "runs")),
        out / "model.json",
        out / "report.html",
        out / "summary.html",
        *(out / DIAGNOSIS / name for name in (DIAGNOSIS_JSON, DIAGNOSIS_PAGE, EXTENDED)),
    ]
    for run_file in plan.run_files(out / "runs"):
        check_not_recording(run_file)
    existing = [t for t in targets if t.exists()]
    if existing and not force:
        raise UsageError(
            f"{existing[0]} exists. Give another folder, --continue to continue its runs, or --force to replace it."
        )


def run_campaign(
    rig: str,
    plan: CampaignFile,
    out: Path,
    twin: TwinSettings,
    wire: str,
    force: bool,
    control: RunControl | None,
    listener_factory: ListenerFactory,
) -> dict[str, Run]:
    """Preview all runs, then make them in order; by label."""
    file = load_rig(rig)
    costs = [preview(step.protocol, file, step.set) for step in plan.step]  # before any current flows
    runs = {}
    with Session(rig, twin=twin, wire=wire, control=control) as session:
        for step, cost, target in zip(plan.step, costs, plan.run_files(out / "runs"), strict=True):
            with listener_factory(cost, target) as listener:
                run_or_resume(
                    session,
                    step.protocol,
                    step.set,
                    target,
                    listeners=[listener] if listener else [],
                    force=force,
                    expected=cost,
                )
            runs[step.label] = load_run(target)
    return runs
