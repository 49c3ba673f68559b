"""Which of strain and stress is the input of a pulled wire: the one that was set, where a model can follow that."""

from smarig.core import shown
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess
from smarig.study.physical_roles import leads, swept_more_evenly

_LOADS, _LENGTHS = (q.STRESS, q.FORCE), (q.STRAIN, q.DISPLACEMENT)


def pulled_roles(drive: ColumnGuess, out: ColumnGuess) -> tuple[ColumnGuess, ColumnGuess, str]:
    """Input and output of a wire that a load and a length describe, and why; "" for other columns.

    A ramp of the machine goes in equal steps. A load that leads its elongation, as that of every specimen that
    dissipates work does, counts as the input whatever was set: no hysteresis leads its input.
    """
    if not is_pulled(drive, out):
        return drive, out, ""
    load, length = shown(drive.name), shown(out.name)
    ahead = leads(drive.facts.values, out.facts.values)
    if out.facts.even and not drive.facts.even and not ahead:
        why = f"{length} goes in equal steps, as a value that is set: the test is controlled by strain"
        return out, drive, f"{why}, and {load} is its output"
    if ahead:
        return drive, out, load_as_input(drive, out)
    by_strain = f"in a test controlled by strain it is the other way round: --input {length} --output {load}"
    return drive, out, f"the {drive.quantity} counts as the input, and {length} as its output; {by_strain}"


def is_pulled(drive: ColumnGuess, out: ColumnGuess) -> bool:
    """Whether a load drives a length."""
    return drive.quantity in _LOADS and out.quantity in _LENGTHS


def load_as_input(drive: ColumnGuess, out: ColumnGuess) -> str:
    """Why the load of a specimen that dissipates work is the input, in words."""
    load, length = shown(drive.name), shown(out.name)
    ramped = out.facts.even or swept_more_evenly(out.facts.values, drive.facts.values)
    control = f", although the machine ramps {length}" if ramped else ""
    return (
        f"the {drive.quantity} counts as the input{control}: {load} leads {length}, as that of a specimen that "
        "dissipates work does, and a hysteresis never leads its input"
    )
