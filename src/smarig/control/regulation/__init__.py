"""Set-point regulation (§8.3): approach the state B_ℓ with the wanted output, then close the loop there.

``anhysteretic_output`` finds ℓ, ``boundary_plane`` measures the distance of a state from B_ℓ, ``approach`` plans the
path to it, ``setpoint_pi`` is the loop that holds the output, ``regulation_protocol`` combines them.
"""

from smarig.control.regulation.anhysteretic_output import Psi
from smarig.control.regulation.approach import ApproachPlan, plan_approach
from smarig.control.regulation.boundary_plane import BoundaryPlane
from smarig.control.regulation.regulation_protocol import regulate
from smarig.control.regulation.setpoint_pi import SetpointPI

__all__ = ["ApproachPlan", "BoundaryPlane", "Psi", "SetpointPI", "plan_approach", "regulate"]
