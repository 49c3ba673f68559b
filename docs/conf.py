"""How the documentation is built: ``sphinx-build -W docs out/docs``. Nothing on a page comes from elsewhere.

The reference is written from the code before anything is read (``generate/``). Formulas are plain text: no
script that typesets mathematics is needed. Refuses to know what a page says.
"""

import gc
import re
import sys
from importlib.metadata import version as installed
from pathlib import Path
from typing import Any

from pygments.lexers.special import TextLexer

gc.disable()  # a fifth of the time; the process ends with the build
HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from generate import write_all  # noqa: E402 - beside this file
from generate.docstring import as_rst  # noqa: E402
from smarig.report import style  # noqa: E402

project = "smarig"
author = "the smarig authors"
copyright = author
release = installed("smarig")
version = release

extensions = ["myst_parser", "sphinx.ext.autodoc"]
smartquotes = False  # "--set" is two hyphens
exclude_patterns = ["generate", "figures", "_build"]
source_suffix = {".md": "markdown"}
nitpicky = True
nitpick_ignore_regex = [
    ("py:.*", ".*")
]  # types of signatures: most are of NumPy, or of modules without a page

myst_enable_extensions = ["deflist"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_class_signature = "mixed"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 100
add_module_names = False
toc_object_entries_show_parents = "hide"

html_theme = "furo"
html_title = f"smarig {release}"
html_static_path = ["static"]
html_css_files = ["house.css"]
html_show_sourcelink = False
html_show_copyright = False
html_copy_source = False
pygments_style = "friendly"
pygments_dark_style = "github-dark"
html_theme_options = {
    "light_css_variables": {
        "font-stack": style.FONT,
        "font-stack--monospace": "ui-monospace, SFMono-Regular, Menlo, Consolas, monospace",
        "color-foreground-primary": style.INK,
        "color-foreground-secondary": "#4d5561",
        "color-foreground-muted": style.GREY,
        "color-brand-primary": style.INK,
        "color-brand-content": "#005a8f",
        "color-link--visited": "#005a8f",
        "color-background-border": style.FAINT,
        "color-background-secondary": "#f7f8fa",
        "color-api-name": style.COOLING,
        "color-api-pre-name": style.GREY,
    },
    "dark_css_variables": {
        "color-brand-primary": "#e8eaee",
        "color-brand-content": style.surface_colour("constant"),
        "color-link--visited": style.surface_colour("constant"),
        "color-api-name": style.surface_colour("constant"),
    },
}


def _plain_docstrings(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Docstrings are plain text with formulas, not markup."""
    del app, what, name, obj, options
    lines[:] = as_rst(lines)


def _short_types(
    app: Any, what: str, name: str, obj: Any, options: Any, signature: str | None, returns: str | None
) -> tuple[str | None, str | None]:
    """``NDArray[float64]`` as it is written in the code, not what it stands for."""
    del app, what, name, obj, options
    if signature and "<factory>" in signature:  # no Python: Sphinx leaves such a signature as it is
        signature = re.sub(r"~(?:\w+\.)*", "", signature).replace("=<factory>", " = …")
    return _named_arrays(signature), _named_arrays(returns)


def _named_arrays(text: str | None) -> str | None:
    return text and re.sub(
        r"~?[\w.]*ndarray\[[^\[\]]*\[[^\[\]]*\], [\w.~]*dtype\[~?([\w.]+)\]\]", r"NDArray[\1]", text
    )


def setup(app: Any) -> None:
    """Write the reference before Sphinx reads, and say what docstrings are."""
    app.add_lexer("csv", TextLexer)
    app.connect("autodoc-process-signature", _short_types)
    app.connect("builder-inited", lambda app: write_all(Path(app.srcdir) / "reference" / "generated"))
    app.connect("autodoc-process-docstring", _plain_docstrings)
