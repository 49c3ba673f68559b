"""The headline figures of a run for pages and lists: temperatures, stroke and width, if it has a full loop."""

from smarig.core import UsageError
from smarig.identification import Estimate
from smarig.record import Run
from smarig.transformation.run_figures import RunFigures, run_figures

HEADLINE = ("A_s", "A_f", "M_s", "M_f", "stroke", "width")


def headline(run: Run) -> dict[str, Estimate]:
    """A_s, A_f, M_s, M_f, stroke and width with their intervals, as far as a run gives them; {} without a full loop."""
    found = full_loop(run)
    return {name: found.estimate(name) for name in HEADLINE if name in found.means} if found else {}


def full_loop(run: Run) -> RunFigures | None:
    """The figures of a run with a full loop of its own, not one assembled from first-order curves; None without."""
    try:
        found = run_figures(run)
    except UsageError:
        return None
    return None if found.assembled or not found.cycles else found
