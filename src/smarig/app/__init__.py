"""Applications that combine several packages: characterise, closed loops, proposals, simulation."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.app.arrays import fit as fit
    from smarig.app.arrays import simulate as simulate
    from smarig.app.characterisation_runs import campaign_previews as campaign_previews
    from smarig.app.characterise import characterise as characterise
    from smarig.app.characterised_folder import characterised_folder as characterised_folder
    from smarig.app.characterised_folder import is_characterisation as is_characterisation
    from smarig.app.closed_loop import certify as certify
    from smarig.app.closed_loop import regulate as regulate
    from smarig.app.closed_loop import track as track
    from smarig.app.loop_model import ClosedLoop as ClosedLoop
    from smarig.app.loop_model import ModelSource as ModelSource
    from smarig.app.loop_model import timing_of as timing_of
    from smarig.app.ophyd_rig import OphydRig as OphydRig
    from smarig.app.ophyd_rig import RunFlyer as RunFlyer
    from smarig.app.proposal import propose_run as propose_run
    from smarig.app.proposal import write_campaign as write_campaign
    from smarig.app.regulation_loop import regulation as regulation
    from smarig.app.simulated_run import simulate_protocol as simulate_protocol
    from smarig.app.simulated_run import simulate_run as simulate_run
    from smarig.app.stepped_run import SteppedRun as SteppedRun
    from smarig.app.tracking_loop import tracking as tracking
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
