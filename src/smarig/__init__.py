"""smarig: rig software for shape-memory-alloy actuators.

    import smarig
    run = smarig.run("first_order_descending", rig="one_wire_twin", out="fod.run.sqlite")
    model = smarig.identify(run, surface="exponential").model

Public names are imported when first used, so that ``import smarig`` is instant.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from smarig.app.closed_loop import regulate as regulate
    from smarig.app.closed_loop import track as track
    from smarig.diagnosis.diagnose import diagnose as diagnose
    from smarig.identification.forc.forc_density import forc_density as forc_density
    from smarig.identification.identify import identify as identify
    from smarig.preisach.hysteresis.fod_surface import FodSurface as FodSurface
    from smarig.preisach.operator import Preisach as Preisach
    from smarig.record.run import load_run as load_run
    from smarig.replay.model_file import load_model as load_model
    from smarig.report.notebook import plot as plot
    from smarig.rig.twin import Twin as Twin
    from smarig.runner.resume.resume_run import resume as resume
    from smarig.runner.session import run as run

_HOME = {
    "FodSurface": "smarig.preisach.hysteresis.fod_surface",
    "Preisach": "smarig.preisach.operator",
    "Twin": "smarig.rig.twin",
    "diagnose": "smarig.diagnosis.diagnose",
    "forc_density": "smarig.identification.forc.forc_density",
    "identify": "smarig.identification.identify",
    "load_model": "smarig.replay.model_file",
    "load_run": "smarig.record.run",
    "plot": "smarig.report.notebook",
    "regulate": "smarig.app.closed_loop",
    "resume": "smarig.runner.resume.resume_run",
    "run": "smarig.runner.session",
    "track": "smarig.app.closed_loop",
}
__all__ = [
    "FodSurface",
    "Preisach",
    "Twin",
    "diagnose",
    "forc_density",
    "identify",
    "load_model",
    "load_run",
    "plot",
    "regulate",
    "resume",
    "run",
    "track",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'smarig' has no attribute '{name}'")
    return getattr(importlib.import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return __all__
