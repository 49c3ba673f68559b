"""Set-point regulation (§8.3): go to the state B_ℓ whose output is wanted, then close the loop there.

``psi`` finds ℓ, ``plane`` measures how near a state is to B_ℓ, ``approach`` plans the way there, ``pi`` is the loop
that holds it, ``loop`` the protocol made of both, ``disturbance`` compares B_ℓ with other states of the same output.
"""

from smarig.control.regulation.approach import ApproachPlan, plan
from smarig.control.regulation.boundary_plane import BoundaryPlane
from smarig.control.regulation.psi import Psi
from smarig.control.regulation.regulation_protocol import regulate
from smarig.control.regulation.setpoint_pi import SetpointPI

__all__ = ["ApproachPlan", "BoundaryPlane", "Psi", "SetpointPI", "plan", "regulate"]
