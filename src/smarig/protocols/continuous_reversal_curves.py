"""First-order descending curves in continuous sweeps at two rates; it waits nowhere but at the lower end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from smarig.core import Elapsed, Hold, Mark, Protocol, StepResult, UsageError, Waveform
from smarig.protocols._building_blocks import checked_count, checked_inputs, evenly_spaced
from smarig.protocols._setup import Setup

_RATES = (0.17, 0.34)  # default rates, in ranges per time constant
_SATURATION_TAUS = 8.0  # a hold of 8 τ comes within 0.03 % of the limit
_RETURN_SHARE = 0.05  # of the range: a fall ends this close to the lower end by the heating law
_REST_TAUS, _STILL_COUNTS = (
    0.5,
    1.0,
)  # the wire is at rest if the mean counts of two rests of 0.5 τ differ by less
_MOST_RESTS = 40
_TOP_SHARE = 0.02  # of the range: a rise to the upper end ends this close to it
_SLEW_SHARE = 0.95  # of the current rate that the limits allow
_LONGEST_TAUS = 1000.0  # a sweep that takes longer is refused


def continuous_reversal_curves(
    setup: Setup,
    *,
    curves: int = 13,
    reversals_K: tuple[float, ...] = (),
    rates_K_per_s: tuple[float, ...] = (),
) -> Protocol:
    """Rise to α, fall to the lower end, rise to the next larger α, … (§5.4.1), in continuous sweeps.

    The *wire* moves at a set rate as far as the heating law (5.1) and the limits allow: the steady temperature of the
    current is s = u + τ du/dt. The rates take turns, so that rises and falls at different rates pass the same inputs:
    only that tells the lag of the heating from the hysteresis. At the lower end the wire rests until its position is
    constant: latent heat delays the cooling, and a rise from a transformation that is not complete starts from an
    unknown phase. The largest curve is measured once at each rate.
    ``curves`` counts evenly spaced reversal inputs α up to the upper end; ``reversals_K`` lists them instead.
    ``rates_K_per_s`` are one or more rates of the wire's temperature (default: 0.17 and 0.34 of the range per τ). With
    one rate only, τ cannot be identified.
    """
    checked_count("curves", curves, 3, 1000)
    rates = _checked_rates(setup, rates_K_per_s)
    alphas = _checked_reversals(setup, curves, reversals_K)
    saturation = Elapsed(_SATURATION_TAUS * setup.tau_s)
    wire = _Sweeper(setup)
    yield Mark("continuous reversal curves", {"rates_K_per_s": list(rates), "reversals_K": list(alphas)})
    yield Hold(setup.current_for(setup.lower_K), saturation, branch="saturate")
    for k, alpha in enumerate(alphas):
        yield wire.sweep(alpha, rates[k % len(rates)], f"rise {k + 1}")
        if k == len(alphas) - 1:
            yield Hold(setup.current_for(alpha), saturation, branch="top")
            wire.rest_at(alpha)
        yield wire.sweep(setup.lower_K, rates[(k + 1) % len(rates)], f"fall {k + 1}")
        yield from wire.rest(f"rest {k + 1}")
    for k, rate in enumerate(rates[1:]):
        yield wire.sweep(alphas[-1], rate, f"rise again {k + 1}")
        yield wire.sweep(setup.lower_K, rates[(len(alphas) + 1 + k) % len(rates)], f"fall again {k + 1}")
        yield from wire.rest(f"rest again {k + 1}")
    yield Hold(0.0, saturation, branch="cool")


def _checked_rates(setup: Setup, rates: Sequence[float]) -> tuple[float, ...]:
    natural = (setup.upper_K - setup.lower_K) / setup.tau_s
    for rate in rates:
        if not 1e-3 * natural <= rate <= natural:
            raise UsageError(
                f"rates_K_per_s: {rate:g} K/s is outside {1e-3 * natural:.2g}…{natural:.3g} K/s, which this wire can "
                "follow."
            )
    return tuple(rates) or tuple(share * natural for share in _RATES)


def _checked_reversals(setup: Setup, curves: int, reversals_K: Sequence[float]) -> tuple[float, ...]:
    """Increasing, so that each rise wipes out the memory of the curve before it (§3.3.1)."""
    if not reversals_K:
        return tuple(evenly_spaced(setup.lower_K, setup.upper_K, curves))
    alphas = checked_inputs(setup, reversals_K, "reversals_K")
    least = setup.at(2 * _RETURN_SHARE)
    if len(alphas) < 3 or alphas[0] < least or any(b <= a for a, b in zip(alphas, alphas[1:])):
        raise UsageError(f"reversals_K needs at least 3 increasing inputs, the first at least {least:.4g} K.")
    return alphas


@dataclass
class _Sweeper:
    """The wire as the heating law (5.1) predicts it, which decides when a sweep has arrived."""

    setup: Setup
    input_K: float = field(init=False)
    current_A: float = field(init=False)

    def __post_init__(self) -> None:
        self.rest_at(self.setup.lower_K)

    def rest_at(self, input_K: float) -> None:
        """The state after a long hold."""
        self.input_K, self.current_A = input_K, self.setup.current_for(input_K)

    def rest(self, branch: str) -> Protocol:
        """Rests at the lower end until the position is constant."""
        seconds, before = _REST_TAUS * self.setup.tau_s, math.nan
        hold = Hold(self.setup.current_for(self.setup.lower_K), Elapsed(seconds), branch=branch)
        for _ in range(_MOST_RESTS):
            result = yield hold
            self._follow(hold.current_A, seconds)
            if not isinstance(result, StepResult) or abs(result.counts - before) < _STILL_COUNTS:
                return
            before = result.counts

    def _follow(self, current_A: float, seconds: float) -> None:
        reached = self.setup.actuator.input_for(current_A)
        self.current_A = current_A
        self.input_K = reached + (self.input_K - reached) * math.exp(-seconds / self.setup.tau_s)

    def sweep(self, target_K: float, rate_K_per_s: float, branch: str) -> Waveform:
        """One monotone sweep of the wire towards a target."""
        setup = self.setup
        span, dt_s = setup.upper_K - setup.lower_K, setup.period_s
        decay, way = math.exp(-dt_s / setup.tau_s), 1.0 if target_K > self.input_K else -1.0
        low, high = setup.lower_K + _RETURN_SHARE * span, setup.upper_K - _TOP_SHARE * span
        low = min(low, (setup.lower_K + self.input_K) / 2)  # a low reversal is a fall too
        end_K = min(target_K, high) if way > 0 else max(target_K, low)
        slew_A = _SLEW_SHARE * setup.limits.current_rate_A_per_s * dt_s
        currents: list[float] = []
        while (end_K - self.input_K) * way > 0:
            wanted = self.input_K + way * rate_K_per_s * dt_s
            source = (wanted - self.input_K * decay) / (1 - decay)
            current = setup.current_for(min(max(source, setup.lower_K), setup.upper_K))
            self.current_A += min(max(current - self.current_A, -slew_A), slew_A)
            reached = setup.actuator.input_for(self.current_A)
            self.input_K = reached + (self.input_K - reached) * decay
            currents.append(self.current_A)
            if len(currents) * dt_s > _LONGEST_TAUS * setup.tau_s:
                raise UsageError(f"continuous_reversal_curves: the wire does not reach {end_K:.4g} K.")
        return Waveform(tuple(currents), dt_s, branch)
