"""Runs in progress on this computer, and checks of rigs: announced by their process, controlled from others."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.running.announcement import announced as announced
    from smarig.running.find_runs import EndedRun as EndedRun
    from smarig.running.find_runs import collect_ended as collect_ended
    from smarig.running.find_runs import runs_in_progress as runs_in_progress
    from smarig.running.memory_layout import SAMPLES as SAMPLES
    from smarig.running.run_in_progress import RunInProgress as RunInProgress
    from smarig.running.run_status import PanelRunInfo as PanelRunInfo
    from smarig.running.run_status import RunStatus as RunStatus
    from smarig.running.run_status import SettlingProgress as SettlingProgress
    from smarig.running.run_status import check_info as check_info
    from smarig.running.run_status import run_info as run_info
    from smarig.running.stop_runs import stop_runs as stop_runs
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
