"""What velocity feedback did, read from the record: measured ratio, k_e, hypotheses, and the signals they are of."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.certify import Hypothesis, failing
from smarig.control import Reference, VelocityFilter, running_ratio
from smarig.report.components.numbers import number

Array = NDArray[np.float64]
MEASURED_KEYS = ("ratio", "raw_ratio", "rest_ratio", "bound_share", "clipped_share", "k_e")
RATIO = "‖ṙ − v‖/(‖ṙ‖ + ‖u_o‖)"


@dataclass(frozen=True)
class VelocityResult:
    """Thm 8.2 beside what was measured; δ, γ and k_e in the units that ``k_e_units`` tells.

    ``rest_ratio`` is that of a wire that stands still, ``bound_share`` the error over the bound that needs no units.
    ``k_e`` is None where the theorem does not cover model and controller, the ratios and ``clipped_share`` None where
    the loop ended early or nothing drove it.
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
        """From a mark; KeyError, TypeError or ValueError where it says too little."""
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
        """The hypotheses that this loop does not keep, or is not known to."""
        return failing(self.hypotheses)

    @property
    def within(self) -> bool | None:
        """Whether the measured ratio is within k_e; None without either."""
        return None if self.k_e is None or self.ratio is None else self.ratio <= self.k_e

    @property
    def better_than_rest(self) -> bool | None:
        """Whether the wire followed better than one that stands still; None without a ratio."""
        return None if self.ratio is None or self.rest_ratio is None else self.ratio < self.rest_ratio

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)


def _number_or_none(value: Any) -> float | None:
    return None if value is None else float(value)


@dataclass(frozen=True, eq=False)
class VelocitySignals:
    """Of a loop's samples, (n,) each: ``rate`` ṙ, ``velocity`` as filtered, ``ratio`` and that of a wire at rest
    up to each.
    """

    rate: Array
    velocity: Array
    ratio: Array
    rest_ratio: Array

    @classmethod
    def of(
        cls, reference: Reference, t_s: Array, position: Array, found: VelocityResult
    ) -> "VelocitySignals":
        """Computed again from the readings; ``t_s`` from where the loop was closed."""
        dt_s = float(np.median(np.diff(t_s)))
        wanted = [(reference.at(t), reference.at(t - dt_s)) for t in t_s.tolist()]
        rate = np.array([(now - before) / dt_s for now, before in wanted])
        velocity_filter = VelocityFilter(dt_s, found.filter_s)
        velocity = np.array([velocity_filter.after(y) for y in position.tolist()])
        offset = np.full(t_s.size, found.offset_K)
        ratios = (running_ratio(rate, v, offset) for v in (velocity, np.zeros_like(velocity)))
        return cls(rate, velocity, *ratios)


def velocity_verdict(velocity: VelocityResult) -> str:
    """The measured ratio held against k_e, and how far that reaches, in a sentence or two."""
    if velocity.ratio is None:
        return "The loop ended before its ratio was measured."
    measured = f"Measured {RATIO} = {number(velocity.ratio)} (a wire at rest: {number(velocity.rest_ratio)})"
    if velocity.k_e is None:
        return f"{measured}. Thm 8.2 gives no k_e for this model and controller: {velocity.coverage}."
    within = "within" if velocity.within else "beyond"
    share = (
        f"; in any units, {number(100 * velocity.bound_share)} % of [(γ + δ)‖ṙ‖ + ‖u_o‖]/δ"
        if velocity.offset_K and velocity.bound_share is not None
        else ""
    )
    return (
        f"{measured}, {within} k_e = {number(velocity.k_e)}{share}. That bound is proved for the operator without "
        "delay, noise and quantum, not for this rig."
    )
