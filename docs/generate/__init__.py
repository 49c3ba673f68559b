"""The generated part of the reference: pages as text, from the code of the installed package.

Each module holds ``pages()``, which gives page names and Markdown. Refuses to know Sphinx.
"""

import importlib
from pathlib import Path

PARTS = ("commands", "keys", "json_objects", "files", "catalogues", "effects", "python")


def pages() -> dict[str, str]:
    """All pages by name, in the order of the reference."""
    return {
        name: text
        for part in PARTS
        for name, text in importlib.import_module(f"generate.{part}").pages().items()
    }


def write_all(folder: Path) -> None:
    """Write what changed, remove what is no longer made."""
    made = {folder / f"{name}.md": text for name, text in pages().items()}
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.md"):
        if old not in made:
            old.unlink()
    for path, text in made.items():
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
