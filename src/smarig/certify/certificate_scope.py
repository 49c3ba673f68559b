"""How far a certificate reaches, and where it ends: sentences that follow from what is proved of the model.

Each is said of one model: what a theorem gives is told only where its hypotheses hold (``CertificateScope``). The
evidence for lag, delay and counts is in docs/explanation/control_findings.md. Refuses to know how they are shown.
"""

from dataclasses import dataclass

from smarig.certify.certificate_units import UNKNOWN, Units
from smarig.certify.storage_bound import BoundBasis

CONTROL_FINDINGS = "docs/explanation/control_findings.md"


@dataclass(frozen=True)
class CertificateLimit:
    """What it is about, in a few words, and a sentence or two."""

    about: str
    text: str


@dataclass(frozen=True)
class CertificateScope:
    """What of the model the sentences rest on: the ground of its storage, Assumption 2.1, and Thm 8.2's verdict."""

    basis: BoundBasis
    monotone: bool
    covered: bool | None
    units: Units = UNKNOWN

    @property
    def dissipative(self) -> bool | None:
        """Whether any storage function exists; None: not decided."""
        return {"none": False, "undecided": None}.get(self.basis, True)


def limits(scope: CertificateScope) -> tuple[CertificateLimit, ...]:
    """All of them, for text, page and JSON alike.

    >>> [limit.about for limit in limits(CertificateScope("none", False, False))]
    ['hysteresis alone', 'delay and counts', 'position loops']
    """
    hysteresis_only = CertificateLimit(
        "hysteresis alone", "It speaks of the hysteresis alone, not of effects, heating or a rig."
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
    """What k_e multiplies and bounds; "" where units are not known."""
    return f"bounds ‖ė‖ in {units.rate} by ‖ṙ‖ in {units.rate} + ‖u_o‖ in {units.input}" if units.gain else ""


def scheduling(scope: CertificateScope) -> str:
    """What is certified of gains on a schedule, as velocity feedback."""
    velocity = (
        "Gain scheduling as velocity feedback: δ is the least gain and γ the largest, whatever it looks at"
    )
    if scope.covered:
        return f"{velocity}, so Thm 8.2 covers it."
    if scope.covered is None:
        return f"{velocity}; what Thm 8.2 asks of the model is not decided, so no bound is known."
    return f"{velocity}; but Thm 8.2 asks more of the model than it has, so there is no bound with it."


def position_loops(scope: CertificateScope) -> str:
    """What is known of the loops that ``track`` and ``regulate`` close."""
    head = (
        "Loops that feed back the position (smarig track and regulate: inverse, pi, gain_scheduled) are not covered by "
        "Thm 8.2, which is about the velocity."
    )
    if not scope.dissipative:
        return f"{head} Nothing is proved of them with this model{_reason_text(scope)}."
    time = "" if scope.monotone else ", in continuous time"
    return (
        f"{head} What is proved with this model: {_storage_symbol(scope)} + Φ(e) never rises{time} for a gain that is "
        "constant or switched by the error alone, at a constant reference and without a tick of delay: the energy is "
        "bounded, and no more."
    )


def position_controllers(scope: CertificateScope) -> str:
    """What is certified of the controllers that §9.2 proposes."""
    if not scope.dissipative:
        return (
            f"Position controllers of §9.2: nothing is certified{_reason_text(scope)}: they ask for a plant that is "
            "dissipative to ⟨u, ẏ⟩ − b²⟨y, y⟩ for some b."
        )
    return (
        "Position controllers of §9.2: this model is dissipative to ⟨u, ẏ⟩ − b²⟨y, y⟩ for b = 0 only, so the strict "
        "class (a, c ≠ 0) is empty; the marginal one (a = b = c = 0) holds the controllers whose K(s)/s is positive "
        "real (proportional, with derivative, lead), and bounds the energy, without delay and without saying that y "
        "arrives at r."
    )


_LAG = (
    "Behind a heating lag and limits of the current the model stays passive, from the temperature that the current "
    "asks for."
)
_DELAY = (
    "A tick of delay and a velocity from counts (filtered, quantised, noisy) break the bound, and a real rig has both: "
    "there k_e is not proved, and at a small ṙ it was exceeded."
)
_NO_BOUND = (
    "No bound of a velocity loop is proved with this model, not even without the tick of delay and the velocity from "
    "counts of a real rig."
)


def _k_e_sentence(units: Units) -> str:
    return f"k_e {k_e_units(units)}, so its number belongs to these units."


def _reason_text(scope: CertificateScope) -> str:
    if scope.dissipative is False:
        return ", because this model is not dissipative"
    return ", because it is not decided whether this model is dissipative"


def _storage_symbol(scope: CertificateScope) -> str:
    return "V = S_a(B)" if scope.basis == "dissipative" else "V = Q_r(B)"
