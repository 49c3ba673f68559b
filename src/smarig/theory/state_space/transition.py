"""The state transition φ (6.8) as constructed in the thesis, and the equivalent sweep of the boundary.

φ is composed of inputs and sequences, so it covers only states that an input can generate. ``sweep`` moves the curve
itself (§3.1: a rising input lifts a level edge, a falling one moves an upright edge to the left). It is the same map
where φ is defined, and it is defined on all of ℬ. A sweep never increases the area between two boundaries, so it is the
only continuous extension of φ.
"""

from smarig.core import UsageError
from smarig.theory.state_space.boundary import Boundary, Point
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import H, H_left

JUMP_TOLERANCE = 1e-9  # relative to û: a smaller jump at t₀ is rounding


def transition(t1: float, t0: float, boundary: Boundary, u: InputSignal) -> Boundary:
    """φ(t₁, t₀, B₀, u) = H_{t₁}ˡ[H_{t₀}B₀ ◇ u_(t₀,t₁]] (6.8): the state at t₁ from B₀ at t₀ ≤ t₁.

    B₀ must be reachable and u admissible: u(t₀) is the input at which B₀ meets α = β (Def. 6.5). Else UsageError.

    >>> from smarig.theory.state_space.boundary import anhysteretic
    >>> transition(2, 0, anhysteretic(10), InputSignal((0, 1, 2), (0, 6, -4))).points
    ((-10.0, 10.0), (-6.0, 6.0), (-4.0, 6.0), (-4.0, -4.0))
    """
    if not t1 >= t0:
        raise UsageError(f"The end t₁ = {t1:g} of a transition must not be before its start t₀ = {t0:g}.")
    past = H(boundary, t0)
    joined = past.joined_with(u.between(t0, t1), slack=JUMP_TOLERANCE * boundary.bound)
    return H_left(joined, t1, boundary.bound)


def sweep(boundary: Boundary, u: float) -> Boundary:
    """The boundary after a monotone move of the input to u, |u| ≤ û, from any boundary of ℬ.

    Rising: the part above α = u stays, followed by a level edge to (u, u). Falling is the mirror image.

    >>> from smarig.theory.state_space.boundary import diagonal
    >>> sweep(diagonal(10, 2), 5).points
    ((-10.0, 10.0), (-6.0, 10.0), (-1.0, 5.0), (5.0, 5.0))
    """
    if not abs(u) <= boundary.bound:
        raise UsageError(f"The input {u:g} is outside [−û, û], û = {boundary.bound:g}.")
    if u >= boundary.u:
        return Boundary((*_above(boundary.points, u), (u, u)), boundary.bound)
    mirrored = _above(_mirror(boundary.points), -u)
    return Boundary((*_mirror(mirrored), (u, u)), boundary.bound)


def _mirror(points: tuple[Point, ...]) -> tuple[Point, ...]:
    """(β, α) → (−α, −β): the plane for −u, with rising and falling exchanged."""
    return tuple((-alpha, -beta) for beta, alpha in points)


def _above(points: tuple[Point, ...], u: float) -> tuple[Point, ...]:
    """The part of the curve with α ≥ u, ending where the curve crosses α = u."""
    n = sum(alpha >= u for _, alpha in points)
    if n == len(points):
        return points
    (b0, a0), (b1, a1) = points[n - 1], points[n]
    share = (a0 - u) / (a0 - a1)
    return *points[:n], (min(b0 + share * (b1 - b0), b1), u)
