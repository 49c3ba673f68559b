"""The Everett function of a hysteresis and the keys of an input, as C: the arithmetic of the Python loop.

Each kind writes three functions, ``key_above``, ``key_below`` and ``between``, and the arrays that they read.
"""

from collections.abc import Sequence
from functools import singledispatch

import numpy as np

from smarig.core import UsageError
from smarig.preisach import Everett, FodSurface, FodTable, Mirrored, RelayMeasure

_RANKED = """static int ranked(const double *levels, int n, double u, int right)
{
    int low = 0, high = n, middle;
    while (low < high) {
        middle = (low + high) / 2;
        if (right ? levels[middle] <= u : levels[middle] < u)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}
"""
_OWN_KEYS = """static double key_above(double u) { return u; }
static double key_below(double u) { return u; }
"""
_RISES = {
    "constant": "P[3]",
    "exponential": "P[3] * exp(-P[4] * a) + P[5]",
    "parabolic": "(P[3] * a + P[4]) * a + P[5]",
}


@singledispatch
def c_hysteresis(hysteresis: Everett) -> str:
    """The C functions of a hysteresis. UsageError for a kind that has none."""
    raise UsageError(
        f"A hysteresis of kind {type(hysteresis).__name__} has no C form. Identify the model with --surface table, "
        "exponential or positive."
    )


@c_hysteresis.register
def _of_surface(hysteresis: FodSurface) -> str:
    form = hysteresis.form
    if form not in _RISES:
        raise UsageError(
            f"A surface of form '{form}' has no C form. Identify the model with --surface exponential."
        )
    parameters = hysteresis.keyed.params
    scale = len(parameters) - 1
    return f"""{array("P", parameters)}{_OWN_KEYS}
static double between(double a, double b)
{{
    double f = {_RISES[form]}, half = 0.5 * P[2];
    double rise = tanh(half * (a + f)) - tanh(half * (b + f));
    return P[{scale}] * (1.0 + tanh(0.5 * P[0] * (a + P[1]))) * rise;
}}
"""


@c_hysteresis.register
def _of_table(hysteresis: FodTable) -> str:
    nodes, inner, drops, width = hysteresis.keyed.params
    return f"""{array("LEVELS", nodes)}{array("DROPS", drops)}#define WIDTH {width}

{_RANKED}
static double key_above(double u)
{{
    int k = ranked(LEVELS + 1, {len(inner)}, u, 1);
    return k + (u - LEVELS[k]) / (LEVELS[k + 1] - LEVELS[k]);
}}

static double key_below(double u) {{ return key_above(u); }}

static double between(double a, double b)
{{
    int i = (int)a, j = (int)b, high = (i + 1) * WIDTH, k, m;
    double s = a - i, t = b - j, near, far;
    if (j >= i)
        return (s - t) * DROPS[high + i];
    k = i * WIDTH + j;
    m = high + j;
    near = DROPS[k] + t * (DROPS[k + 1] - DROPS[k]);
    far = DROPS[m] + t * (DROPS[m + 1] - DROPS[m]);
    return near + s * (far - near);
}}
"""


@c_hysteresis.register
def _of_relays(hysteresis: RelayMeasure) -> str:
    alphas, betas, sums, width = hysteresis.keyed.params
    return f"""{array("ALPHAS", alphas)}{array("BETAS", betas)}{array("SUMS", sums)}
{_RANKED}
static double key_above(double u) {{ return (double)ranked(ALPHAS, {len(alphas)}, u, 1) * {width}; }}
static double key_below(double u) {{ return (double)ranked(BETAS, {len(betas)}, u, 0); }}
static double between(double a, double b) {{ return SUMS[(int)a + (int)b]; }}
"""


@c_hysteresis.register
def _of_mirrored(hysteresis: Mirrored) -> str:
    """F(α, β) = F̃(−β, −α): the keys of an input are those of its mirror image, exchanged."""
    own = c_hysteresis(hysteresis.image)
    for name in ("key_above", "key_below", "between"):
        own = own.replace(f"{name}(", f"image_{name}(")
    return f"""{own}
static double key_above(double u) {{ return image_key_below(-u); }}
static double key_below(double u) {{ return image_key_above(-u); }}
static double between(double a, double b) {{ return image_between(b, a); }}
"""


def array(name: str, values: Sequence[float] | np.ndarray) -> str:
    """A constant array; one unused zero if there are no values, because C has no empty arrays."""
    numbers = [repr(float(v)) for v in values] or ["0.0"]
    rows = [", ".join(numbers[k : k + 5]) for k in range(0, len(numbers), 5)]
    return f"static const double {name}[] = {{\n    " + ",\n    ".join(rows) + "};\n"
