"""Tail probabilities and quantiles of test statistics, bit for bit those of scipy.stats.

scipy.stats itself takes 50 MB and most of a second to import, for every command and every worker.
"""

from scipy.special import betaincinv, chdtrc, fdtrc, fdtri, gammaincinv, ndtri, stdtr, stdtrit


def chi2_tail(x: float, freedom: float) -> float:
    """P(χ² > x); NaN without degrees of freedom.

    >>> round(chi2_tail(3.841, 1), 4)
    0.05
    """
    return float(chdtrc(freedom, max(x, 0.0))) if freedom > 0 and x == x else float("nan")


def chi2_quantile(p: float, freedom: float) -> float:
    """The x with P(χ² ≤ x) = p."""
    return float(2 * gammaincinv(freedom / 2, p))


def f_tail(x: float, numerator: float, denominator: float) -> float:
    """P(F > x) of Fisher's F; NaN without degrees of freedom.

    >>> round(f_tail(4.26, 2, 9), 3)
    0.05
    """
    if not (numerator > 0 and denominator > 0 and x == x):
        return float("nan")
    return float(fdtrc(numerator, denominator, x)) if 0 < x < float("inf") else float(x <= 0)


def f_quantile(p: float, numerator: float, denominator: float) -> float:
    """The x with P(F ≤ x) = p."""
    return float(fdtri(numerator, denominator, p))


def beta_quantile(p: float, a: float, b: float) -> float:
    """The x with P(β ≤ x) = p of the beta distribution."""
    return float(betaincinv(a, b, p))


def t_tail(x: float, freedom: float) -> float:
    """P(t > x) of Student's t."""
    return float(stdtr(freedom, -x))


def t_quantile(p: float, freedom: float) -> float:
    """The x with P(t ≤ x) = p."""
    return float(stdtrit(freedom, p))


def normal_quantile(p: float) -> float:
    """The x with P(z ≤ x) = p of the standard normal distribution."""
    return float(ndtri(p))
