"""The result of velocity feedback, computed from the record: measured ratio, k_e, hypotheses and signals."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from smarig.certificate import Hypothesis, failing
from smarig.control import Reference, VelocityFilter, running_ratio
from smarig.core import Array
from smarig.report.components.numbers import number

MEASURED_KEYS = ("ratio", "raw_ratio", "rest_ratio", "bound_share", "clipped_share", "k_e")
RATIO = "‖ṙ − v‖/(‖ṙ‖ + ‖u_o‖)"


@dataclass(frozen=True)
class VelocityResult:
    """The quantities of Thm 8.2 and the measured ratio; δ, γ and k_e in the units given by ``k_e_units``.

    ``rest_ratio`` is the ratio of a wire at rest. ``bound_share`` is the error divided by the bound, in any units.
    ``k_e`` is None if the theorem does not cover model and controller. The ratios and ``clipped_share`` are None if
    the loop ended early or its reference did not move.
    """

    ratio: float | None
    raw_ratio: float | None
    rest_ratio: float | None
    bound_share: float | None
    clipped_share: float | None
    k_e: float | None
    delta: float
    gamma: float
    offset_K: float
    filter_s: float
    lead_in_s: float
    coverage: str
    gain_unit: str
    k_e_units: str
    hypotheses: tuple[Hypothesis, ...]

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> "VelocityResult":
        """From the data of a mark; KeyError, TypeError or ValueError if they are incomplete."""
        values: dict[str, Any] = {key: _number_or_none(data.get(key)) for key in MEASURED_KEYS}
        values |= {key: float(data[key]) for key in ("delta", "gamma", "offset_K", "filter_s")}
        units = data["units"]
        return cls(
            **values,
            lead_in_s=float(data.get("lead_in_s", 0.0)),
            coverage=str(data["coverage"]),
            gain_unit=str(units["gain"]),
            k_e_units=str(units["k_e"]),
            hypotheses=tuple(
                Hypothesis(str(h["name"]), h["holds"], str(h["why"])) for h in data["hypotheses"]
            ),
        )

    @property
    def failing(self) -> tuple[Hypothesis, ...]:
        """The hypotheses that this loop violates, or that are not decided."""
        return failing(self.hypotheses)

    @property
    def within(self) -> bool | None:
        """Whether the measured ratio is within k_e; None without either."""
        return None if self.k_e is None or self.ratio is None else self.ratio <= self.k_e

    @property
    def better_than_rest(self) -> bool | None:
        """Whether the wire tracked better than a wire at rest; None without a ratio."""
        return None if self.ratio is None or self.rest_ratio is None else self.ratio < self.rest_ratio

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)


def _number_or_none(value: Any) -> float | None:
    return None if value is None else float(value)


@dataclass(frozen=True, eq=False)
class VelocitySignals:
    """Signals at a loop's samples, (n,) each: ``rate`` ṙ, filtered ``velocity``, and the ratios up to each sample."""

    rate: Array
    velocity: Array
    ratio: Array
    rest_ratio: Array

    @classmethod
    def of(
        cls, reference: Reference, t_s: Array, position: Array, found: VelocityResult
    ) -> "VelocitySignals":
        """Computed from the readings; ``t_s`` since the loop was closed."""
        dt_s = float(np.median(np.diff(t_s)))
        wanted = [(reference.at(t), reference.at(t - dt_s)) for t in t_s.tolist()]
        rate = np.array([(now - before) / dt_s for now, before in wanted])
        velocity_filter = VelocityFilter(dt_s, found.filter_s)
        velocity = np.array([velocity_filter.after(y) for y in position.tolist()])
        offset = np.full(t_s.size, found.offset_K)
        ratios = (running_ratio(rate, v, offset) for v in (velocity, np.zeros_like(velocity)))
        return cls(rate, velocity, *ratios)


def velocity_verdict(velocity: VelocityResult) -> str:
    """The measured ratio compared with k_e, and the scope of that bound, in one or two sentences."""
    if velocity.ratio is None:
        return "The loop ended before the ratio was measured."
    measured = f"Measured {RATIO} = {number(velocity.ratio)} (wire at rest: {number(velocity.rest_ratio)})"
    if velocity.k_e is None:
        return f"{measured}. Thm 8.2 gives no k_e for this model and controller: {velocity.coverage}."
    within = "within the bound" if velocity.within else "above the bound"
    share = (
        f"; in any units, {number(100 * velocity.bound_share)} % of [(γ + δ)‖ṙ‖ + ‖u_o‖]/δ"
        if velocity.offset_K and velocity.bound_share is not None
        else ""
    )
    return (
        f"{measured}, {within} k_e = {number(velocity.k_e)}{share}. The bound is proved for the operator without "
        "delay, noise and quantisation; it is not proved for this rig."
    )
