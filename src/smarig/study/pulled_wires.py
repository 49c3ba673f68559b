"""Which of strain and stress is the input of a pulled wire: the one that was set, where equal steps show it."""

from smarig.core import shown
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess

_LOADS, _LENGTHS = (q.STRESS, q.FORCE), (q.STRAIN, q.DISPLACEMENT)


def pulled_roles(drive: ColumnGuess, out: ColumnGuess) -> tuple[ColumnGuess, ColumnGuess, str]:
    """Input and output of a wire that a load and a length describe, and why; "" for other columns.

    A ramp of the machine goes in equal steps. Where neither column does, the load counts as the input.
    """
    if drive.quantity not in _LOADS or out.quantity not in _LENGTHS:
        return drive, out, ""
    load, length = shown(drive.name), shown(out.name)
    if out.facts.even and not drive.facts.even:
        why = f"{length} goes in equal steps, as a value that is set: the test is controlled by strain"
        return out, drive, f"{why}, and {load} is its output"
    by_strain = f"in a test controlled by strain it is the other way round: --input {length} --output {load}"
    return drive, out, f"the {drive.quantity} counts as the input, and {length} as its output; {by_strain}"
