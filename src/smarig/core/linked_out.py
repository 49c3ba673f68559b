"""Symbolic links in a folder that lead out of it: whoever made the folder chose their targets."""

from pathlib import Path


def leads_out(file: Path, folder: Path) -> bool:
    """Whether a file below a folder is, or lies behind, a symbolic link to a place outside of that folder."""
    try:
        return not file.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):  # links in a circle
        return True
