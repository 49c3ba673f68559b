"""A non-negative measure from any data: the rigorous identification the thesis asks for (§5.6, §9.2)."""

from smarig.identification.positive.fit import PositiveFit as PositiveFit
from smarig.identification.positive.fit import fit_positive as fit_positive
from smarig.identification.positive.loops import observations_of_loops as observations_of_loops
from smarig.identification.positive.observations import Observations as Observations
