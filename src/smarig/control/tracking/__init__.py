"""Position tracking: references, controllers (one file each), the loop that drives them, and its performance."""

from smarig.control.tracking.controller_model import ControllerModel
from smarig.control.tracking.reference import Reference, reference
from smarig.control.tracking.tracking_protocol import track

__all__ = ["ControllerModel", "Reference", "reference", "track"]
