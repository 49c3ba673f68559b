"""The runner executes protocols on any rig; however a run ends, the current is zero."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.runner.bounded_listener import BoundedListener as BoundedListener
    from smarig.runner.bring_up_history import BringUpHistory as BringUpHistory
    from smarig.runner.end_severity import end_severity as end_severity
    from smarig.runner.initialisation_spread import initialisation_spread as initialisation_spread
    from smarig.runner.listener import CallbackListener as CallbackListener
    from smarig.runner.listener import Listener as Listener
    from smarig.runner.listener import StepStartListener as StepStartListener
    from smarig.runner.lock import rig_locks as rig_locks
    from smarig.runner.preview import Preview as Preview
    from smarig.runner.preview import ProtocolFactory as ProtocolFactory
    from smarig.runner.preview import preview as preview
    from smarig.runner.resume.launch_args import read_launch_args as read_launch_args
    from smarig.runner.resume.resume_plan import RE_ESTABLISH as RE_ESTABLISH
    from smarig.runner.resume.resume_run import resume as resume
    from smarig.runner.resume.resume_run import resume_in as resume_in
    from smarig.runner.resume.resume_run import session_for as session_for
    from smarig.runner.resume.run_or_resume import run_or_resume as run_or_resume
    from smarig.runner.run_control import RunControl as RunControl
    from smarig.runner.run_metadata import twin_source as twin_source
    from smarig.runner.run_protocol import run as run
    from smarig.runner.runner import Runner as Runner
    from smarig.runner.session import Session as Session
    from smarig.runner.settling_detection import Approach as Approach
    from smarig.runner.settling_detection import SettleWindow as SettleWindow
    from smarig.runner.signal_handling import stop_on_signals as stop_on_signals
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
