"""smarig: rig software for shape-memory-alloy actuators.

    import smarig
    run = smarig.run("first_order_descending", rig="one_wire_twin", out="fod.run.sqlite")
    model = smarig.identify(run, surface="exponential").model

Public names are imported on first use, so that ``import smarig`` is fast.
"""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.app import SteppedRun as SteppedRun
    from smarig.app import certify as certify
    from smarig.app import fit as fit
    from smarig.app import regulate as regulate
    from smarig.app import simulate as simulate
    from smarig.app import track as track
    from smarig.core import use_plugin as use_plugin
    from smarig.diagnosis import diagnose as diagnose
    from smarig.identification import forc_density as forc_density
    from smarig.identification import identify as identify
    from smarig.identification import verify as verify
    from smarig.preisach import FodSurface as FodSurface
    from smarig.preisach import Preisach as Preisach
    from smarig.record import load_run as load_run
    from smarig.replay import load_model as load_model
    from smarig.report import plot as plot
    from smarig.rig import Twin as Twin
    from smarig.rig import TwinSettings as TwinSettings
    from smarig.runner import Session as Session
    from smarig.runner import resume as resume
    from smarig.runner import run as run
    from smarig.transformation import transformation_temperatures as transformation_temperatures
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
