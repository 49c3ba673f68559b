"""The live view: a run is drawn while it is recorded, or afterwards.

Samples go into a bounded queue (``draw_queue``). ``scene_renderer`` turns them into primitives, which are
plain values. Only ``rerun_output`` passes primitives to a viewer.
"""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.live.display_info import rig_display_info as rig_display_info
    from smarig.live.live_view import live_listener as live_listener
    from smarig.live.live_view import save_recording as save_recording
    from smarig.live.live_view import view_run as view_run
    from smarig.live.preisach_plane import boundary as boundary
    from smarig.live.rerun_output import viewer_state as viewer_state
    from smarig.live.viewer_process import ViewerProcess as ViewerProcess
    from smarig.live.viewer_process import free_port as free_port
    from smarig.live.viewer_process import parent_death_signal as parent_death_signal
    from smarig.live.viewer_process import viewer_address as viewer_address
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
