"""Identification and choice of the extensions of a model (§3.5), by their gain on runs left out in turn.

Each run is left out once. Model and extension are identified from the other runs and predict it, up to one offset
each (the encoder's zero). The gain is 1 − (rms extended/rms classical)². Its 95 % interval comes from resampling
excursions between saturations. "best" is the extension of least error with a positive gain in the whole interval,
else none.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from smarig.core import Array, DataError, UsageError, catalogue_entry, catalogue_names, spaced
from smarig.identification.extended.chord_test import ChordTest, equal_chords
from smarig.identification.extended.extension_names import BEST, EXTENSIONS, NONE
from smarig.identification.extended.extremum_chains import excursions, extremum_chains
from smarig.identification.extended.fitted_extension import ExtensionData, FittedExtension
from smarig.identification.noise_floor import noise_floor
from smarig.preisach import Everett, Preisach
from smarig.record import Run
from smarig.replay import extended_operator

Refit = Callable[[Sequence[Run]], Everett]
_DRAWS = 999


@dataclass(frozen=True, eq=False)
class HeldOutExtension:
    """Squared errors (blocks,) of both models on runs left out, and their numbers of points (blocks,)."""

    classical: Array
    extended: Array
    points: Array
    runs: int

    def rms(self) -> tuple[float, float]:
        """Rms errors of the classical and of the extended model."""
        n = self.points.sum()
        return float(np.sqrt(self.classical.sum() / n)), float(np.sqrt(self.extended.sum() / n))

    @property
    def gain(self) -> float:
        """Share of the classical model's squared error that the extension removes; negative if it is worse."""
        return 1.0 - float(self.extended.sum() / self.classical.sum())

    def interval(self) -> tuple[float, float]:
        """95 % interval of the gain, by resampling blocks with a fixed seed."""
        drawn = np.random.default_rng(0).integers(0, self.points.size, (_DRAWS, self.points.size))
        gains = 1.0 - self.extended[drawn].sum(axis=1) / self.classical[drawn].sum(axis=1)
        low, high = np.quantile(gains, (0.025, 0.975))
        return float(low), float(high)

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        classical, extended = self.rms()
        return {
            "classical": classical,
            "extended": extended,
            "gain": self.gain,
            "gain_ci95": list(self.interval()),
            "runs": self.runs,
            "points": int(self.points.sum()),
            "blocks": self.points.size,
        }


@dataclass(frozen=True, eq=False)
class ExtensionChoice:
    """The chosen extension ("none": the classical model), every extension that could be fitted, and why others
    could not.

    ``held_out`` has no entry for an extension that could not be identified with a run left out.
    """

    chosen: str
    fits: dict[str, FittedExtension]
    held_out: dict[str, HeldOutExtension]
    refused: dict[str, str]
    chords: ChordTest | None
    unit: str

    @property
    def values(self) -> dict[str, Any]:
        """The values for the model file; empty for the classical model."""
        return self.fits[self.chosen].values if self.chosen != NONE else {}

    def to_json(self) -> dict[str, Any]:
        """Plain values, under the key ``extension``."""
        fits = {
            name: fit.to_json()
            | {"held_out": self.held_out[name].to_json() if name in self.held_out else None}
            for name, fit in self.fits.items()
        }
        c = self.chords
        chords = c and {
            "verdict": c.verdict,
            "p_congruent": c.p_congruent,
            "p_chords": c.p_chords,
            "loops": c.loops,
        }
        return {"chosen": self.chosen, "fits": fits, "refused": self.refused, "chord_test": chords}

    @property
    def text(self) -> str:
        """A line for each extension."""
        lines = [f"Extension: {self.chosen}."]
        if self.chords:
            c = self.chords
            lines.append(
                f"  Verdict of comparable loops: {c.verdict} (congruent p = {c.p_congruent:.2g}, equal chords "
                f"p = {c.p_chords:.2g}, {c.loops} loops)."
            )
        for name, fit in self.fits.items():
            numbers = ", ".join(f"{key} = {value}" for key, value in fit.parameters.items())
            lines.append(f"  {name}: {numbers}; p = {fit.p_value:.2g}; {self._held_out_text(name)}.")
        return "\n".join(
            [*lines, *(f"  {name}: not identified: {why}" for name, why in self.refused.items())]
        )

    def _held_out_text(self, name: str) -> str:
        if name not in self.held_out:
            return "no run could be left out"
        h = self.held_out[name]
        (classical, extended), (low, high) = h.rms(), h.interval()
        gain = "worse" if high < 0 else f"gain {100 * h.gain:.0f} % ({100 * low:.0f} % to {100 * high:.0f} %)"
        return f"runs left out: rms error {classical:.3g} → {extended:.3g}{spaced(self.unit)}, {gain}"


def choose_extension(
    runs: Sequence[Run], hysteresis: Everett, unit: str, name: str, refit: Refit
) -> ExtensionChoice:
    """Identify one extension of a hysteresis, or all of them for "best".

    ``refit`` identifies the classical hysteresis from fewer runs. Raises UsageError for an unknown name, and
    DataError if a named extension cannot be identified from these runs.
    """
    data = ExtensionData(runs, hysteresis, unit)
    fits, refused = {}, {}
    for candidate in catalogue_names(EXTENSIONS) if name == BEST else [name]:
        identify_extension = catalogue_entry(EXTENSIONS, candidate)
        try:
            fits[candidate] = identify_extension(data)
        except (DataError, UsageError) as error:
            if name != BEST:  # what an extension refuses follows from the data, not from the command
                raise DataError(str(error)) from None
            refused[candidate] = str(error)
    folds = list(_folds(runs, refit)) if fits else []
    scored = {candidate: _held_out(candidate, folds, unit) for candidate in fits}
    held_out = {candidate: score for candidate, score in scored.items() if score is not None}
    chosen = _best(held_out) if name == BEST else name
    return ExtensionChoice(chosen, fits, held_out, refused, _chords(runs), unit)


def _best(held_out: dict[str, HeldOutExtension]) -> str:
    gained = {name: score.gain for name, score in held_out.items() if score.interval()[0] > 0}
    return max(gained, key=gained.__getitem__, default=NONE)


def _folds(runs: Sequence[Run], refit: Refit):
    """(runs kept, their hysteresis, the run left out), if the other runs suffice."""
    for k, left_out in enumerate(runs):
        kept = [*runs[:k], *runs[k + 1 :]]
        try:
            yield kept, refit(kept), left_out
        except (DataError, UsageError):
            continue


def _held_out(name: str, folds: Sequence[Any], unit: str) -> HeldOutExtension | None:
    squares, used = [], 0
    for kept, hysteresis, left_out in folds:
        try:
            values = catalogue_entry(EXTENSIONS, name)(ExtensionData(kept, hysteresis, unit)).values
            record = extremum_chains([left_out])
        except (DataError, UsageError):
            continue
        both = (Preisach(hysteresis), extended_operator(values, hysteresis))
        errors = [operator.simulate(record.u) - record.y for operator in both]
        block = np.unique(excursions(record), return_inverse=True)[1]
        squares.append([np.bincount(block), *(np.bincount(block, (e - e.mean()) ** 2) for e in errors)])
        used += 1
    if not squares:
        return None
    points, classical, extended = (np.concatenate(column) for column in zip(*squares))
    return HeldOutExtension(classical, extended, points, used)


def _chords(runs: Sequence[Run]) -> ChordTest | None:
    """The chord test, if the runs contain comparable loops and determine their noise."""
    try:
        return equal_chords(runs, noise_floor(runs))
    except DataError:
        return None
