"""``smarig new plugin``: writes an installable package with one example of each kind of plug-in, and its tests.

The templates are valid files named ``my_KIND`` and ``my_plugin``. Only those words are replaced.
"""

import re
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

from smarig.core import PLUGIN_GROUPS, StorageError, UsageError

_TEMPLATES = Path(__file__).parent / "starting_points"
_PACKAGE, _TESTS = _TEMPLATES / "plugin", "tests_of_"  # not "test_", which pytest would collect here
PLUGIN_KINDS = {
    group.removeprefix("smarig.").removesuffix("s").replace("_", "-"): group for group in PLUGIN_GROUPS
}
DISTRIBUTION = "my-plugin"


def write_plugin_package(name: str, module: str, kinds: Sequence[str], folder: Path) -> list[Path]:
    """Write the package of a distribution ``name`` to a new folder, whole or not at all. Returns its files.

    Raises UsageError if the folder exists, StorageError if it cannot be written.
    """
    if folder.exists() or folder.is_symlink():
        raise UsageError(f"{folder} exists. Give another name, or another folder with -o.")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".smarig-") as scratch:
            made = Path(scratch) / "package"
            for path, text in _files(name, module, kinds).items():
                (made / path).parent.mkdir(parents=True, exist_ok=True)
                (made / path).write_text(text, encoding="utf-8", newline="\n")
            shutil.move(made, folder)
    except OSError as error:
        raise StorageError(f"{folder} cannot be written: {error.strerror or error}.") from None
    return sorted(path for path in folder.rglob("*") if path.is_file())


def plugin_names(module: str, kinds: Sequence[str]) -> dict[str, str]:
    """The name of the example of each kind.

    >>> plugin_names("acme", ["effect", "surface-form"])
    {'effect': 'acme_effect', 'surface-form': 'acme_surface_form'}
    """
    return {kind: f"{module}_{_word(kind)}" for kind in kinds}


def _word(kind: str) -> str:
    return kind.replace("-", "_")


def _files(name: str, module: str, kinds: Sequence[str]) -> dict[str, str]:
    """The text of each file by its path in the package."""
    named = plugin_names(module, kinds)
    templates = {
        "pyproject.toml": _PACKAGE / "pyproject.toml",
        "README.md": _PACKAGE / "README.md",
        f"src/{module}/__init__.py": _PACKAGE / "__init__.py",
        "tests/conftest.py": _PACKAGE / "tests" / "conftest.py",
        "tests/test_entry_points.py": _PACKAGE / "tests" / f"{_TESTS}entry_points.py",
    }
    for kind, example in named.items():
        templates[f"src/{module}/{example}.py"] = _TEMPLATES / f"my_{_word(kind)}.py"
        templates[f"tests/test_{example}.py"] = _PACKAGE / "tests" / f"{_TESTS}my_{_word(kind)}.py"
    words = {f"my_{_word(kind)}": example for kind, example in named.items()}
    words |= {DISTRIBUTION: name, "my_plugin": module}
    return {path: _filled(template, words, module, named) for path, template in templates.items()}


def _filled(template: Path, words: dict[str, str], module: str, named: dict[str, str]) -> str:
    """The text of a template with the words of this package. A plug-in is named without a path."""
    text = template.read_text(encoding="utf-8")
    text = re.sub(r"\./(my_\w+)\.py\b", r"\1", text).replace("a rig file in the same folder:", "a rig file:")
    for word, replacement in words.items():
        text = re.sub(rf"(?<![\w-]){word}(?![\w-])", replacement, text)
    points = "".join(
        f'[project.entry-points."{PLUGIN_KINDS[kind]}"]\n{example} = "{module}.{example}:{example}"\n\n'
        for kind, example in named.items()
    )
    rows = "\n".join(
        f"| `{example}` | {kind.replace('-', ' ')} | `src/{module}/{example}.py` |"
        for kind, example in named.items()
    )
    return text.replace("# ENTRY POINTS\n", points).replace("<!-- PLUG-INS -->", rows)
