"""Which runs of several folders are compared: of each folder the run of one protocol that all of them hold.

A folder of ``characterise`` begins with an initialisation, which hardly heats the wire: it shows nothing of the loops.
"""

from collections.abc import Sequence
from pathlib import Path

from smarig.record import load_run

_BEST_FIRST = (
    "first_order_descending",
    "first_order_ascending",
    "validation",
)  # by what they show of the loops
_SHOWS_NO_LOOP = "initialise"


def runs_of_folders(folders: Sequence[Sequence[Path]]) -> tuple[list[Path], str]:
    """The files to compare, and the protocol that they share.

    Without one that each folder holds, all files that show loops, or simply all, and "".
    """
    protocols = [{file: load_run(file).info.protocol or "" for file in files} for files in folders]
    common = set.intersection(*({*one.values()} for one in protocols)) - {_SHOWS_NO_LOOP, ""}
    if not common:
        every = [(file, protocol) for one in protocols for file, protocol in one.items()]
        return [file for file, protocol in every if protocol != _SHOWS_NO_LOOP] or [f for f, _ in every], ""
    shared = next((p for p in _BEST_FIRST if p in common), min(common))
    return [next(file for file, protocol in one.items() if protocol == shared) for one in protocols], shared
