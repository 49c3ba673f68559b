"""Symbolic links in a folder that lead out of it: whoever made the folder chose their targets."""

from pathlib import Path

_MOST_LINKS = 40  # behind each other, as in Linux


def leads_out(file: Path, folder: Path) -> bool:
    """Whether a file below a folder is, or lies behind, a symbolic link to a place outside of that folder."""
    try:
        return not file.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):  # links in a circle
        return True


def place_inside(path: Path, folder: Path) -> Path | None:
    """Where a path leads below a folder, through links too; None if it leads out. Nothing outside is looked up.

    ``leads_out`` asks the system, which looks at every place on the way.
    """
    at = real = folder.resolve()
    left, links = _below(path, folder, real), 0
    while left:
        part = left.pop(0)
        if part == "..":
            if at == real:
                return None
            at = at.parent
            continue
        try:
            target = at / (at / part).readlink()
        except OSError:  # no link, or nothing there
            at /= part
            continue
        links += 1
        rest = _below(target, folder, real)
        if rest is None or links > _MOST_LINKS:
            return None
        left, at = rest + left, real
    return None if left is None else at


def _below(path: Path, *folders: Path) -> list[str] | None:
    """The parts of a path after those of the folder; None if it begins elsewhere. A folder may have several names."""
    return next((list(path.parts[len(f.parts) :]) for f in folders if path.is_relative_to(f)), None)
