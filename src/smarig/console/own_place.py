"""Where the console writes. Whoever made its folder also chose the links in it, which could lead anywhere."""

from pathlib import Path

from smarig.core import UsageError, place_inside, shown


def is_own_place(place: Path, folder: Path) -> bool:
    """Whether a place below the folder of a console is no link, and lies behind none."""
    return place_inside(place, folder) == folder.resolve() / place.relative_to(folder)


def own_place(place: Path, folder: Path) -> Path:
    """A place below the folder of a console. Raises UsageError if it is a link, or lies behind one."""
    if not is_own_place(place, folder):
        raise UsageError(
            f"{shown(str(place.relative_to(folder)))} is a link, or lies behind one. Remove the link: the console "
            "writes there, and only into its own folder."
        )
    return place
