"""How far a model is off, and by how much its slope is: a Kalman filter on the difference from what is measured.

    y − ŷ = d + noise,        d ← d + g Δŷ + walk,        g ← g + walk with the way travelled

ŷ is the model's output, d its error, g the relative error of its slope dy/dŷ − 1. A hysteresis that is scaled or
shifted is off by an error that changes as the output moves, not as time passes: that is what g foretells, and why
the filter may be slow against the encoder's noise. Knows nothing of temperatures and currents.
"""

from dataclasses import dataclass, replace

INITIAL_OFFSET_SHARE, INITIAL_SLOPE_SD = (
    0.02,
    0.2,
)  # standard deviations before anything was seen: of the range, of the slope
MIN_SLOPE_ERROR, MAX_SLOPE_ERROR = -0.7, 2.0  # a model whose slope is further off is not one to invert


@dataclass(frozen=True, slots=True)
class SlopeObserver:
    """d and g with their covariance; ``noise`` is the standard deviation of a reading, in the output's unit.

    ``walk`` per √s and ``slope_walk`` per √(output unit) are what d and g may change by.
    """

    noise: float
    walk: float
    slope_walk: float
    d: float = 0.0
    g: float = 0.0
    dd: float = 0.0
    dg: float = 0.0
    gg: float = INITIAL_SLOPE_SD**2
    model: float = 0.0

    @classmethod
    def at(cls, model: float, span: float, noise: float, walk: float, slope_walk: float) -> "SlopeObserver":
        """Before the first reading: the model's output now, and the range of outputs."""
        return cls(noise, walk, slope_walk, dd=(INITIAL_OFFSET_SHARE * span) ** 2, model=model)

    def updated(self, measured: float, model: float, dt_s: float) -> "SlopeObserver":
        """After a tick: a reading and the model's output in it."""
        move = model - self.model
        d = self.d + self.g * move
        dd = self.dd + move * (2 * self.dg + move * self.gg) + self.walk**2 * dt_s
        dg = self.dg + move * self.gg
        gg = min(self.gg + self.slope_walk**2 * abs(move), 1.0)
        total = dd + self.noise**2
        kd, kg = dd / total, dg / total
        innovation = measured - model - d
        return replace(
            self,
            model=model,
            d=d + kd * innovation,
            g=min(max(self.g + kg * innovation, MIN_SLOPE_ERROR), MAX_SLOPE_ERROR),
            dd=dd - kd * dd,
            dg=dg - kd * dg,
            gg=gg - kg * dg,
        )

    def model_for(self, target: float) -> float:
        """The model output at which the wire would be where it is wanted."""
        return self.model + (target - self.model - self.d) / (1 + self.g)
