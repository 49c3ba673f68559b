"""The page of a certificate: verdict, hypotheses, k_e of each controller, μ and ψ, limits and provenance."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from smarig.certificate import (
    CONTROL_FINDINGS,
    MeasuredPassivity,
    ModelCertificate,
    PositionController,
    RobustCertificate,
    StorageBound,
    Units,
)
from smarig.core import spaced
from smarig.replay import Model
from smarig.report.certificate.certificate_figures import certificate_figure
from smarig.report.components.html import (
    Html,
    cards,
    joined,
    notice,
    paragraph,
    table,
    tag,
    with_subscripts,
)
from smarig.report.components.numbers import number, runs_text, thousands
from smarig.report.components.page import Section, page
from smarig.report.components.run_description import display_unit
from smarig.report.models.model_tables import M_P, M_PC

HOLDS_TEXT = {True: "holds", False: "fails", None: "not decided"}
_BOX_STYLES = {True: "good", False: "bad", None: "warning"}


@dataclass(frozen=True)
class CertifiedModel:
    """The model of a certificate: name, file, hash, and the runs it was identified from."""

    model: str
    file: str
    sha256: str
    twin: bool
    rig: str
    data: tuple[dict[str, Any], ...]
    effects: tuple[str, ...]

    def summary_text(self) -> str:
        """A sentence on the model, its data, and the effects that the certificate does not cover."""
        runs = ", ".join(f"{r['protocol']} ({r['rows']} rows)" for r in self.data) or "no recorded run"
        kind = "twin data" if self.twin else "measured data"
        return (
            f"Certificate of {self.model} ({self.file}, SHA-256 {self.sha256[:12]}…), identified on {self.rig} from "
            f"{kind}: {runs}.{self.exclusion_text()}"
        )

    def exclusion_text(self) -> str:
        """A sentence on the effects of the model; "" without effects."""
        if not self.effects:
            return ""
        return f" The certificate covers the hysteresis of the model, not its effects ({', '.join(self.effects)})."

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        plain = asdict(self)
        return {**plain, "covers": "the hysteresis alone" if self.effects else "the model's hysteresis"}


def certified_model(model: Model, file: str, sha256: str) -> CertifiedModel:
    """The description of a model and its file."""
    kept = ("sha256", "protocol", "source", "rows")
    runs = tuple({"run": Path(p.run).name} | {key: getattr(p, key) for key in kept} for p in model.provenance)
    effects = tuple(str(e.get("name")) for e in model.effects)
    return CertifiedModel(
        model=model.name, file=file, sha256=sha256, twin=model.twin, rig=model.rig, data=runs, effects=effects
    )


def certificate_units(model: Model) -> Units:
    """The units of the model's hysteresis, which may not contain them itself."""
    return Units(model.unit, model.input.unit)


@dataclass(frozen=True)
class Further:
    """Results in addition to the model's certificate: passivity of runs by name, position controllers of §9.2, and the
    probability over the uncertainty of the model (None if it was not requested).
    """

    measured: dict[str, MeasuredPassivity]
    position_controllers: tuple[PositionController, ...]
    robust: RobustCertificate | None = None

    @property
    def text(self) -> list[str]:
        """One line per result."""
        lines = [f"{name}: {m.text}" for name, m in self.measured.items()]
        lines += [k.text for k in self.position_controllers]
        return lines + ([self.robust.text] if self.robust else [])

    def to_json(self) -> dict[str, Any]:
        """Plain values; keys only for results that exist."""
        measured = [{"run": name} | m.to_json() for name, m in self.measured.items()]
        position = [k.to_json() for k in self.position_controllers]
        robust = self.robust.to_json() if self.robust else None
        found = {"measured": measured, "position_supply": position, "robust": robust}
        return {key: value for key, value in found.items() if value}


def certificate_page(
    model: Model, found: ModelCertificate, about: CertifiedModel, further: Further | None = None
) -> str:
    """The whole page (HTML); ``further``: additional results."""
    label = "TWIN" if model.twin else ""
    sections = [
        Section(
            "Verdict",
            "Verdict",
            [verdict_box(found), certificate_cards(found), *_robust(further), *_exclusion_notice(about)],
        ),
        Section("Velocity feedback", "Velocity feedback", [*velocity_parts(found)]),
        Section("Hypotheses", "Hypotheses", [hypotheses_table(found)]),
        Section(
            "Weighting function and set-points",
            "μ and ψ",
            [certificate_figure(model, found, _caption(about), label)],
        ),
        Section("Limits", "Limits", [limits_table(found)]),
        Section("Other loops", "Other loops", [*other_loops(found), *_position_controllers(further)]),
        *_measured_section(further),
        Section("Model and data", "Provenance", [provenance(about)]),
    ]
    simulated = "the model was identified from a software simulation. No wire was measured."
    title = f"Certificate of {about.model}"
    return page(title, f"{about.file}, identified on {about.rig}", sections, label=label, simulated=simulated)


def certificate_parts(found: ModelCertificate, about: CertifiedModel) -> list[Html]:
    """A certificate as part of another page: verdict, table, hypotheses, provenance."""
    return [
        verdict_box(found),
        *_exclusion_notice(about),
        *velocity_parts(found),
        hypotheses_table(found),
        limits_table(found),
        paragraph(about.summary_text()),
    ]


def verdict_box(found: ModelCertificate) -> Html:
    """A box with the verdict on passivity, and a counterexample if there is one."""
    parts = [paragraph(tag("b", with_subscripts(found.verdict)))]
    if found.dissipativity is not None:
        parts.append(paragraph(found.dissipativity.text))
    if found.counterexample is not None:
        parts.append(paragraph(found.counterexample_text))
    return notice(_BOX_STYLES[found.passive], *parts)


def certificate_cards(found: ModelCertificate) -> Html:
    """Cards of the classes of μ, the storage function and the bias."""
    c, s = found.classes, found.storage_bound
    inside = (
        joined(["μ ≥ 0: in ", M_P])
        if c.M_P
        else joined(["μ < 0 somewhere: in ", M_PC, " only"])
        if c.M_PC
        else "neither of both classes"
    )
    basis = {
        "positive": "Q_r",
        "recoverable": "Q_r",
        "dissipative": "S_a",
        "none": "none exists",
        "undecided": "unknown",
    }[s.basis]
    initial = "B*" if found.initial == "anhysteretic" else "negative saturation"
    return cards(
        [
            ("Class of μ", inside, f"g ≥ 0: {'yes' if found.g_not_negative else 'no'}"),
            ("Storage", with_subscripts(basis), _storage_text(s)),
            ("Bias from u(0) = 0", _bias_text(found), f"initial state: {initial}"),
        ]
    )


def _storage_text(s: StorageBound) -> str:
    if s.basis in ("none", "undecided"):
        return "no storage function exists" if s.basis == "none" else "not decided"
    why = {"positive": "by Thm 7.4", "recoverable": "proved, although μ < 0 somewhere"}
    return why.get(s.basis, "proved" if s.proven else "only a lower bound is known")


def _bias_text(found: ModelCertificate) -> str:
    if found.storage_bound.basis in ("none", "undecided"):
        return "no bound" if found.storage_bound.basis == "none" else "unknown"
    return f"{number(found.storage_bound.energy)}{spaced(display_unit(found.storage_bound.unit))}"


def velocity_parts(found: ModelCertificate) -> list[Html]:
    """The statement of Thm 8.2, and k_e of each controller."""
    per = display_unit(found.units.gain)
    rows = [
        (
            j.name,
            ", ".join(f"{key} = {value:g}" for key, value in j.numbers.items()),
            number(j.stability.delta),
            number(j.stability.gamma),
            number(j.k_e),
            j.coverage,
        )
        for j in found.controllers
    ]
    header = ("Controller", "Settings", f"δ ({per})", f"γ ({per})", with_subscripts("k_e"), "Thm 8.2")
    words = (
        "Velocity controllers from ė to ũ: δ from ⟨ė, ũ⟩ ≥ δ‖ė‖², γ from ‖ũ‖ ≤ γ‖ė‖, k_e = max{γ + δ, 1}/δ where "
        "Thm 8.2 covers the loop."
    )
    return [
        paragraph(with_subscripts(found.velocity_text)),
        table(header, rows, with_subscripts(words), stacked=True),
    ]


def limits_table(found: ModelCertificate) -> Html:
    """The scope of the certificate."""
    rows = [(with_subscripts(limit.about), with_subscripts(limit.text)) for limit in found.limits]
    return table(("Topic", "Statement"), rows, f"Scope of the certificate; see {CONTROL_FINDINGS}.")


def other_loops(found: ModelCertificate) -> list[Html]:
    """Statements on scheduled gains and on position controllers."""
    return [
        paragraph(with_subscripts(found.scheduling)),
        paragraph(with_subscripts(found.position_controllers)),
        paragraph(with_subscripts(found.integral.text)),
        *([paragraph(found.indistinguishable.text)] if found.indistinguishable else []),
    ]


def _robust(further: Further | None) -> list[Html]:
    return [paragraph(with_subscripts(further.robust.text))] if further and further.robust else []


def _position_controllers(further: Further | None) -> list[Html]:
    return [paragraph(k.text) for k in further.position_controllers] if further else []


def _measured_section(further: Further | None) -> list[Section]:
    """Supplied energy of each run against the model's bound."""
    if further is None or not further.measured:
        return []
    rows = [
        (
            name,
            s.first,
            s.supplied.size,
            number(float(s.supplied.min())),
            number(float(s.supplied[-1])),
            number(s.bound),
            {True: "holds", False: "broken", None: s.why}[s.within],
        )
        for name, m in further.measured.items()
        for s in m.segments
    ]
    unit = display_unit(next(iter(further.measured.values())).unit)
    header = (
        "Run",
        "From row",
        "Samples",
        f"Minimum of ∫u dy ({unit})",
        f"At the end ({unit})",
        f"Bound ({unit})",
        "Bound",
    )
    words = "Supplied energy of each segment, computed from the readings and the predicted input."
    parts = [paragraph(f"{name}: {m.text}") for name, m in further.measured.items()]
    return [Section("Measured runs", "Measured runs", [*parts, table(header, rows, words)])]


def hypotheses_table(found: ModelCertificate) -> Html:
    """All hypotheses of both theorems, with verdict and reason."""
    rows = [("Thm 8.1", h.name, HOLDS_TEXT[h.holds], with_subscripts(h.why)) for h in found.hypotheses]
    rows += [
        ("Thm 8.2", with_subscripts(h.name), HOLDS_TEXT[h.holds], with_subscripts(h.why))
        for h in found.controllers[0].stability.hypotheses
        if not h.name.startswith("H₁")
    ]
    return table(
        ("Theorem", "Hypothesis", "Verdict", "Why"),
        rows,
        "All hypotheses of both theorems. Those on H₁ hold by construction.",
    )


def _exclusion_notice(about: CertifiedModel) -> list[Html]:
    return [notice("warning", paragraph(about.exclusion_text().strip()))] if about.effects else []


def _caption(about: CertifiedModel) -> str:
    rows = sum(r["rows"] for r in about.data)
    return f"Model {about.model}, rig {about.rig}, {runs_text(len(about.data))}, n = {thousands(rows)} rows."


def provenance(about: CertifiedModel) -> Html:
    """The model file and the runs it was identified from, with their hashes."""
    rows: list[tuple[Any, ...]] = [(about.file, "model", "", "", tag("code", about.sha256))]
    rows += [
        (r["run"], r["protocol"].replace("_", " "), r["source"], r["rows"], tag("code", r["sha256"]))
        for r in about.data
    ]
    return table(("File", "Content", "Source", "Rows", "SHA-256"), rows, "Model and data.")
