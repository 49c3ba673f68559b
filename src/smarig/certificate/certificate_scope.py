"""The scope of a certificate: sentences that follow from the proved properties of one model (``CertificateScope``).

A theorem's result is stated only if its hypotheses hold. docs/explanation/control_findings.md gives the evidence for
lag, delay and counts.
"""

from dataclasses import dataclass

from smarig.certificate.certificate_units import UNKNOWN, Units
from smarig.certificate.storage_bound import BoundBasis

CONTROL_FINDINGS = "docs/explanation/control_findings.md"


@dataclass(frozen=True)
class CertificateLimit:
    """One limit of a certificate: its subject in a few words, and a sentence or two."""

    about: str
    text: str


@dataclass(frozen=True)
class CertificateScope:
    """The properties behind the sentences: basis of the storage bound, Assumption 2.1, and the result of Thm 8.2."""

    basis: BoundBasis
    monotone: bool
    covered: bool | None
    units: Units = UNKNOWN

    @property
    def dissipative(self) -> bool | None:
        """Whether any storage function exists; None if not decided."""
        return {"none": False, "undecided": None}.get(self.basis, True)


def limits(scope: CertificateScope) -> tuple[CertificateLimit, ...]:
    """All limits, shared by text, page and JSON.

    >>> [limit.about for limit in limits(CertificateScope("none", False, False))]
    ['hysteresis alone', 'delay and counts', 'position loops']
    """
    hysteresis_only = CertificateLimit(
        "hysteresis alone", "The certificate covers the hysteresis alone, not effects, heating or a rig."
    )
    lag = [CertificateLimit("lag and limits", _LAG)] if scope.dissipative and scope.monotone else []
    units = (
        [CertificateLimit("units of k_e", _k_e_sentence(scope.units))]
        if scope.covered and scope.units.gain
        else []
    )
    delay = CertificateLimit("delay and counts", _DELAY if scope.covered else _NO_BOUND)
    return (hysteresis_only, *lag, delay, *units, CertificateLimit("position loops", position_loops(scope)))


def k_e_units(units: Units) -> str:
    """The quantities that k_e relates; "" if units are not known."""
    return f"bounds ‖ė‖ in {units.rate} by ‖ṙ‖ in {units.rate} + ‖u_o‖ in {units.input}" if units.gain else ""


def scheduling(scope: CertificateScope) -> str:
    """What is certified of gain scheduling as velocity feedback."""
    velocity = (
        "Gain scheduling as velocity feedback: δ is the smallest gain and γ the largest, for every schedule"
    )
    if scope.covered:
        return f"{velocity}, so Thm 8.2 covers it."
    if scope.covered is None:
        return f"{velocity}. Whether the model satisfies Thm 8.2 is not decided, so no bound is known."
    return f"{velocity}. The model does not satisfy Thm 8.2, so there is no bound."


def position_loops(scope: CertificateScope) -> str:
    """What is known of the loops that ``track`` and ``regulate`` close."""
    head = (
        "Thm 8.2 is about the velocity. It does not cover loops that feed back the position (smarig track and "
        "regulate: inverse, pi, gain_scheduled)."
    )
    if not scope.dissipative:
        return f"{head} Nothing is proved about them with this model{_reason_text(scope)}."
    time = "" if scope.monotone else ", in continuous time"
    return (
        f"{head} Proved with this model{time}: {_storage_symbol(scope)} + Φ(e) does not increase if the gain is "
        "constant or switched by the error alone, the reference is constant, and there is no tick of delay. This "
        "bounds the energy and nothing else."
    )


def position_controllers(scope: CertificateScope) -> str:
    """What is certified of the position controllers of §9.2."""
    if not scope.dissipative:
        return (
            f"Position controllers of §9.2: nothing is certified{_reason_text(scope)}. They require a plant that is "
            "dissipative to ⟨u, ẏ⟩ − b²⟨y, y⟩ for some b."
        )
    return (
        "Position controllers of §9.2: this model is dissipative to ⟨u, ẏ⟩ − b²⟨y, y⟩ for b = 0 only, so the strict "
        "class (a, c ≠ 0) is empty. The marginal class (a = b = c = 0) contains the controllers whose K(s)/s is "
        "positive real (proportional, with derivative, lead). It bounds the energy without delay. It does not prove "
        "that y converges to r."
    )


_LAG = (
    "Behind a heating lag and current limits the model stays passive, with the steady temperature of the commanded "
    "current as its input."
)
_DELAY = (
    "A tick of delay and a velocity from counts (filtered, quantised, noisy) invalidate the bound. A real rig has "
    "both: k_e is not proved there, and a small ṙ exceeded it."
)
_NO_BOUND = (
    "No bound of a velocity loop is proved with this model, even without a tick of delay and with the exact "
    "velocity."
)


def _k_e_sentence(units: Units) -> str:
    return f"k_e {k_e_units(units)}, so its value depends on these units."


def _reason_text(scope: CertificateScope) -> str:
    if scope.dissipative is False:
        return ", because this model is not dissipative"
    return ", because it is not decided whether this model is dissipative"


def _storage_symbol(scope: CertificateScope) -> str:
    return "V = S_a(B)" if scope.basis == "dissipative" else "V = Q_r(B)"
