"""The positive identification: a non-negative measure from any data, as the thesis calls for (§5.6, §9.2)."""

from smarig.identification.positive.loop_observations import observations_of_loops as observations_of_loops
from smarig.identification.positive.observations import Observations as Observations
from smarig.identification.positive.positive_fit import PositiveFit as PositiveFit
from smarig.identification.positive.positive_fit import fit_positive as fit_positive
