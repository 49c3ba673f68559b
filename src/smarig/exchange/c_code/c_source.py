"""The header and the source of a model in C99, from the templates ``operator.h`` and ``operator.c``.

Templates and not a library or a code generator: firmware compiles one file, and a reader can check it.
"""

import re
from dataclasses import dataclass
from importlib.resources import files

import numpy as np

from smarig.core import UsageError
from smarig.exchange.c_code.c_hysteresis import array, c_hysteresis
from smarig.preisach import InverseSolver
from smarig.replay import Model

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@dataclass(frozen=True)
class CSource:
    """The texts of ``name``.h and ``name``.c."""

    name: str
    header: str
    source: str


def c_source(model: Model, name: str) -> CSource:
    """The C source of a classical model; ``name`` begins all public names and is the name of the files.

    Raises UsageError for an extended model, for a hysteresis without a C form, and for a name that C does not allow.
    """
    model.check_classical("Export as C")
    if not _NAME.fullmatch(name):
        raise UsageError(f"'{name}' is not a name in C. Use letters, digits and underscores, first a letter.")
    h, solver = model.hysteresis, InverseSolver(model.hysteresis)
    constants = {
        "LOWER": h.lower,
        "UPPER": h.upper,
        "Y_LOWER": h.y_lower,
        "ROUNDING": solver.rounding,
        "SLACK": solver.slack,
    }
    kinks, nodes = np.asarray(solver.kinks), np.asarray(solver.nodes)
    lines = [f"/* Written by smarig from the model {_comment(model.name)}. See {name}.h. */"]
    lines += [f'#include "{name}.h"', "#include <math.h>", ""]
    lines += [f"#define {key} ({float(value)!r})" for key, value in constants.items()]
    lines += [f"#define STEPS {int(bool(solver.steps))}", f"#define MONOTONE {int(solver.monotone)}"]
    if solver.monotone:
        nodes = nodes[:0]  # read only where a move may reverse the output
    lines += [f"#define N_KINKS {kinks.size}", f"#define N_NODES {nodes.size}", ""]
    lines += [array("KINKS", kinks), array("NODES", nodes), c_hysteresis(h)]
    texts = {
        "INPUT_UNIT": _comment(model.input.unit or "1"),
        "OUTPUT_UNIT": _comment(model.unit or "1"),
        "LOWER_TEXT": f"{h.lower:g}",
        "UPPER_TEXT": f"{h.upper:g}",
        "MODEL_H": f"{name.upper()}_H",
        "MODEL_EXTREMA": f"{name.upper()}_EXTREMA",
        "the model MODEL": f"the model {_comment(model.name)}",
        "MODEL": name,
    }
    header, operator = (_filled(_template(file), texts) for file in ("operator.h", "operator.c"))
    return CSource(name, header, "\n".join(lines) + operator)


def _filled(template: str, texts: dict[str, str]) -> str:
    """The template with its words replaced in one pass, longer ones first."""
    words = "|".join(re.escape(word) for word in sorted(texts, key=len, reverse=True))
    return re.sub(words, lambda found: texts[found[0]], template)


def _template(file: str) -> str:
    return (files("smarig.exchange.c_code") / file).read_text(encoding="ascii")


def _comment(text: str) -> str:
    """Text that cannot end a comment, in ASCII."""
    return (
        text.encode("ascii", "replace")
        .decode("ascii")
        .replace("*/", "* /")
        .replace("\\", "/")
        .replace("\n", " ")
    )
