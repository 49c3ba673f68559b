"""Which cycles of a run its means are taken over, and which of them are comparable enough for a drift.

All figures of a run come from the same cycles, so that span and width are those of the temperatures: the cycles that
have every figure of the one with the most figures. A drift compares cycles, which needs the same range of temperature.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from smarig.transformation.cycle_figures import FIGURES, TEMPERATURES, CycleFigures

_SAME_END = 0.05  # of the temperature's range: the ends of comparable cycles differ by less from their median
_FEWEST = 3


def complete_cycles(cycles: Sequence[CycleFigures]) -> list[CycleFigures]:
    """The cycles that have all figures of the cycle with the most; of several sets, the one of most cycles."""

    def having(names: frozenset[str]) -> list[CycleFigures]:
        return [c for c in cycles if names <= set(c.figures)]

    most = max(len(c.figures) for c in cycles)
    sets = [frozenset(c.figures) for c in cycles if len(c.figures) == most]
    return having(max(dict.fromkeys(sets), key=lambda names: len(having(names))))


def left_out_note(cycles: Sequence[CycleFigures], averaged: Sequence[CycleFigures]) -> Iterator[str]:
    """A sentence with the cycles that the means leave out, and what each of them lacks."""
    used = {c.number for c in averaged}
    names = [n for n in FIGURES if any(n in c.figures for c in averaged)]
    by_missing: dict[tuple[str, ...], list[int]] = {}
    for c in cycles:
        if c.number not in used:
            by_missing.setdefault(_missing(c, names), []).append(c.number)
    if by_missing:
        lacking = [
            f"{cycles_text(numbers)} {'has' if len(numbers) == 1 else 'have'} no {_in_words(missing)}"
            for missing, numbers in by_missing.items()
        ]
        yield f"All figures are those of {cycles_text(sorted(used))}; {'; '.join(lacking)}."


def _missing(cycle: CycleFigures, names: Sequence[str]) -> tuple[str, ...]:
    """The figures that a cycle lacks: of its temperatures, on which the others depend, if one is among them."""
    missing = [n for n in names if n not in cycle.figures]
    return tuple([n for n in missing if n in TEMPERATURES] or missing)


def _in_words(names: Sequence[str]) -> str:
    return " and ".join(filter(None, [", ".join(names[:-1]), names[-1]]))


def cycles_text(numbers: Sequence[int]) -> str:
    """Cycles in words.

    >>> cycles_text([2]), cycles_text([1, 2, 3, 7])
    ('cycle 2', 'cycles 1 to 3, 7')
    """
    groups: list[list[int]] = []
    for n in numbers:
        if groups and n == groups[-1][-1] + 1:
            groups[-1].append(n)
        else:
            groups.append([n])
    parts = [str(g[0]) if len(g) == 1 else f"{g[0]} to {g[-1]}" for g in groups]
    return f"cycle{'s' if len(numbers) > 1 else ''} {', '.join(parts)}"


def comparable_cycles(cycles: Sequence[CycleFigures]) -> tuple[list[CycleFigures], str]:
    """The cycles between about the same temperatures, and why there is no drift; "" if there are three or more."""
    ends = np.array([_ends(c) for c in cycles])
    middle = np.median(ends, axis=0)
    near = np.all(np.abs(ends - middle) <= _SAME_END * (middle[1] - middle[0]), axis=1)
    comparable = [c for c, same in zip(cycles, near) if same]
    if len(comparable) >= _FEWEST:
        return comparable, ""
    if len(cycles) < _FEWEST:
        return [], f"a drift needs {_FEWEST} cycles, and there {_are(len(cycles))}"
    return (
        [],
        f"a drift needs {_FEWEST} cycles between the same temperatures, and there {_are(len(comparable))}",
    )


def _are(count: int) -> str:
    return f"{'is' if count == 1 else 'are'} {count or 'none'}"


def _ends(cycle: CycleFigures) -> tuple[float, float]:
    branches = [b for b in (cycle.heating, cycle.cooling) if b is not None]
    return min(float(b.u.min()) for b in branches), max(float(b.u.max()) for b in branches)
