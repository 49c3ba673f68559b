"""Position tracking: references, controllers (one file each), the loop that drives them, and how well it went."""

from smarig.control.tracking.known import Known
from smarig.control.tracking.loop import track
from smarig.control.tracking.reference import Reference, reference

__all__ = ["Known", "Reference", "reference", "track"]
