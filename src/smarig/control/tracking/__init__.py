"""Position tracking: references, controllers (one file each), the loop that drives them, and how well it went."""

from smarig.control.tracking.controller_model import ControllerModel
from smarig.control.tracking.reference import Reference, reference
from smarig.control.tracking.tracking_protocol import track

__all__ = ["ControllerModel", "Reference", "reference", "track"]
