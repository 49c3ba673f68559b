"""What held-out runs show and the training runs do not: the variable that predicts the blocks of all runs best."""

from collections.abc import Sequence

from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem
from smarig.diagnosis.comparison.commanded.commanded_search import VARIABLES
from smarig.diagnosis.comparison.commanded.variable_trials import Discrepancies
from smarig.diagnosis.comparison.weights import PAIR_NATS
from smarig.record import Run
from smarig.replay import build_timeline


def variable_of_all_runs(subject: CommandedProblem, runs: Sequence[Run]) -> str | None:
    """The variable that the errors of all ``runs`` go with, or None if none predicts left-out blocks better.

    For errors that the training runs of ``subject`` do not show, or explain by a cause that held-out runs refute: those
    are further blocks, and the density is identified from all.
    """
    timeline = build_timeline(list(runs), subject.given.actuator.tau_s)
    joint = CommandedProblem.of(timeline, subject.given, subject.catalogue)
    smooth = Discrepancies.about(joint, joint.base)
    best = max(smooth.hypotheses(VARIABLES), key=lambda h: h.score)
    return best.parts[-1].name if best.score > joint.trial(joint.base).score + PAIR_NATS else None
