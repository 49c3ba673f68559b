"""A sampled loop around the operator without delay: the input that is consistent with the output that it causes.

    u = command(y(u)),   y(u) = Γ at T + (1 − e^{−dt/τ})(u − T)

The command does not increase with the output (negative feedback) and the output does not decrease with the input
(Assumption 2.1), so u − command(y(u)) increases. The root is unique and lies between the present temperature and the
command at the present output. τ = 0 is the operator alone; with τ > 0 the input is the steady temperature of the wire.
Operators with jumps are refused, because a root need not exist.
"""

import math
from collections.abc import Callable

from smarig.core import DataError, UsageError
from smarig.preisach import Everett, Initial, Preisach, bracketed_root

_RESIDUAL_TOLERANCE = 1e-9  # relative to the input range


class LaggedOperator:
    """The operator behind a heating lag τ = ``lag_s`` (0: none), moved in ticks of ``dt_s``.

    Inputs are clipped to the operator's range, as current limits would do.
    """

    def __init__(self, hysteresis: Everett, initial: Initial, dt_s: float, lag_s: float = 0.0) -> None:
        if not (dt_s > 0 and lag_s >= 0 and math.isfinite(dt_s) and math.isfinite(lag_s)):
            raise UsageError(f"A loop needs dt_s > 0 and lag_s ≥ 0, got {dt_s:g} and {lag_s:g}.")
        if len(getattr(hysteresis, "steps", ())):
            raise UsageError(
                "A measure of relays jumps at its thresholds, so a loop around it need not have a solution "
                "(Thm 8.2 requires μ ∈ M_PC). Give a surface or a table."
            )
        self.operator = Preisach(hysteresis, initial)
        self.lower, self.upper = hysteresis.lower, hysteresis.upper
        self._lag_fraction = 1.0 if lag_s == 0 else -math.expm1(-dt_s / lag_s)

    @property
    def y(self) -> float:
        """Output."""
        return self.operator.y

    @property
    def temperature(self) -> float:
        """The input of the operator."""
        return self.operator.u

    def output_at(self, u: float) -> float:
        """Output after a tick at input u, without changing the state."""
        return self.operator.peek(self._input_after_tick(u))

    def step(self, u: float) -> float:
        """Make a tick at input u and return the output."""
        return self.operator.step(self._input_after_tick(u))

    def _input_after_tick(self, u: float) -> float:
        present = self.operator.u
        return present + self._lag_fraction * (min(max(u, self.lower), self.upper) - present)

    def solve(self, command: Callable[[float], float], *, jumps: bool = False) -> float:
        """u = command(y(u)). Raises DataError if the output runs against the input and no root was found.

        A command that ``jumps`` down with the output may have a sign change instead of a root: the input that keeps
        the output at the jump, between the commands on both sides (sliding, Filippov).
        """
        present = self.temperature
        command_at_rest = command(self.y)

        def residual(u: float) -> float:
            return u - command(self.output_at(u))

        near, far = (present, command_at_rest) if command_at_rest > present else (command_at_rest, present)
        u = bracketed_root(residual, near, far)
        if not jumps and abs(residual(u)) > _RESIDUAL_TOLERANCE * (
            self.upper - self.lower + abs(command_at_rest)
        ):
            raise DataError(
                f"The loop has no solution between {near:g} and {far:g}, where the output falls as the input rises."
            )
        return u
