"""Energies relay by relay as in Table 7.1: an independent reference for ``smarig.theory.energy``.

The relays of ``relay_reference`` do their own switching work, −1 → +1 at α and +1 → −1 at β. There is no
boundary, no moments, and no code shared with the package. ``Game`` is the whole state graph of a few relays
on a few levels: the energies that any input can extract.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st

from preisach import relay_reference


@dataclass
class Relays(relay_reference.Relays):
    """Relays that count the work done on them so far, and how often each has switched."""

    supplied: float = 0.0
    switched: np.ndarray | None = None

    @classmethod
    def off(cls, alpha, beta, mass, u: float) -> "Relays":
        """All relays at −1, the input at u."""
        alpha, beta, mass = (np.asarray(x, dtype=float) for x in (alpha, beta, mass))
        return cls(alpha, beta, 2 * mass, np.zeros(alpha.size, bool), u, 0.0, np.zeros(alpha.size, int))

    def go(self, u: float) -> None:
        """Move monotonically to u, paying for every switch."""
        before = self.on.copy()
        super().go(u)
        up, down = self.on & ~before, before & ~self.on
        self.supplied += float((self.nu * self.alpha)[up].sum() - (self.nu * self.beta)[down].sum())
        if self.switched is not None:
            self.switched = self.switched + up + down

    def along(self, inputs: Iterable[float]) -> "Relays":
        """Go through all inputs."""
        for u in inputs:
            self.go(float(u))
        return self

    @property
    def stored(self) -> float:
        """Sum of Table 7.1's last column."""
        first = self.on & (self.alpha > 0) & (self.beta > 0)
        third = ~self.on & (self.alpha < 0) & (self.beta < 0)
        return float((self.nu * self.beta)[first].sum() - (self.nu * self.alpha)[third].sum())


@dataclass
class Game:
    """All states a few relays can reach from −1 on their levels, and the work of every move between them."""

    moves: list[list[tuple[int, float]]]
    start: dict[tuple, int]

    @classmethod
    def of(cls, alpha, beta, mass, levels) -> "Game":
        """Breadth first from negative saturation, moves to any level."""
        first = Relays.off(alpha, beta, mass, levels[0])
        known, queue, moves = {cls.key(first): 0}, [first], []
        while len(moves) < len(queue):
            here, out = queue[len(moves)], []
            for u in levels:
                there = Relays(here.alpha, here.beta, here.nu, here.on.copy(), here.u)
                there.go(u)
                if cls.key(there) not in known:
                    known[cls.key(there)] = len(queue)
                    queue.append(there)
                out.append((known[cls.key(there)], there.supplied))
            moves.append(out)
        return cls(moves, known)

    @staticmethod
    def key(relays: Relays) -> tuple:
        """What a state is."""
        return (*relays.on.tolist(), relays.u)

    def best(self) -> np.ndarray | None:
        """Most energy any input takes from each state (Bellman–Ford); None if some cycle gives for ever."""
        to = np.array([[k for k, _ in out] for out in self.moves])
        given = -np.array([[w for _, w in out] for out in self.moves])
        value = np.zeros(len(to))
        for _ in range(len(to) + 2):
            better = np.maximum(value, (given + value[to]).max(axis=1))
            if np.all(better <= value + 1e-9):
                return value
            value = better
        return None


LEVELS = np.array([-3.0, -1.5, -1.0, 0.0, 0.5, 2.0, 3.0])


@st.composite
def relays(draw, levels=LEVELS, low: float = -1.0, high: float = 1.0, diagonal: bool = True):
    """α, β, mass of 3 … 12 relays on the levels, thresholds at both ends; masses in [low, high]."""
    n = draw(st.integers(1, 10))
    pair = st.tuples(st.integers(0, levels.size - 1), st.integers(0, levels.size - 1))
    pairs = [tuple(sorted(p)) for p in draw(st.lists(pair, min_size=n, max_size=n))]
    pairs = [p for p in pairs if diagonal or p[0] < p[1]] + [(0, levels.size - 1), (0, 1)]
    steps = st.integers(round(low * 16), round(high * 16)).map(lambda k: k / 16)
    mass = draw(st.lists(steps, min_size=len(pairs), max_size=len(pairs)))
    down, up = np.array(pairs).T
    return levels[up], levels[down], np.array(mass)


def histories(levels=LEVELS, most: int = 14):
    """Inputs on the levels."""
    return st.lists(st.sampled_from(levels.tolist()), min_size=1, max_size=most)
