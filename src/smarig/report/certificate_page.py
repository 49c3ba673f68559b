"""The page of a certificate: verdict, hypotheses, k_e of each controller, μ and ψ, and what it all rests on."""

import re
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from smarig.control.certificate import Certificate
from smarig.control.hypothesis import Hypothesis
from smarig.control.scope import FINDINGS
from smarig.control.storage import Storage
from smarig.control.units import Units
from smarig.identification.model_file import Model
from smarig.report.conditions import exact_unit
from smarig.report.figures_certificate import plane_figure
from smarig.report.html import Html, cards, escaped, joined, notice, paragraph, table, tag
from smarig.report.numbers import number
from smarig.report.page import Section, page
from smarig.report.tables_model import M_P, M_PC

_HOLDS = {True: "holds", False: "fails", None: "not decided"}
_INDEX = re.compile(r"\b(Q|S|k|u|Δy|M)_(PC|P|r|a|e|o|k)\b")
_BOX = {True: "good", False: "bad", None: "warning"}


@dataclass(frozen=True)
class Origin:
    """What a certificate is about: model, file, hash, and the runs its data came from."""

    model: str
    file: str
    sha256: str
    twin: bool
    rig: str
    data: tuple[dict[str, Any], ...]
    effects: tuple[str, ...]

    def sentence(self) -> str:
        """Model, data, and what is left out."""
        runs = ", ".join(f"{r['protocol']} ({r['rows']} rows)" for r in self.data) or "no recorded run"
        kind = "twin data" if self.twin else "measured data"
        return (
            f"Certificate of {self.model} ({self.file}, SHA-256 {self.sha256[:12]}…), identified on {self.rig} from "
            f"{kind}: {runs}.{self.left_out()}"
        )

    def left_out(self) -> str:
        """What a model with effects is told."""
        if not self.effects:
            return ""
        return f" The model has effects ({', '.join(self.effects)}): they are not covered, only its hysteresis is."

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        plain = asdict(self)
        return {**plain, "covers": "the hysteresis alone" if self.effects else "the model's hysteresis"}


def origin(model: Model, file: str, sha256: str) -> Origin:
    """Of a model and its file."""
    runs = tuple(
        {
            "run": Path(p.run).name,
            "sha256": p.sha256,
            "protocol": p.protocol,
            "source": p.source,
            "rows": p.rows,
        }
        for p in model.provenance
    )
    effects = tuple(str(e.get("name")) for e in model.effects)
    return Origin(model.name, file, sha256, model.twin, model.rig, runs, effects)


def units_of(model: Model) -> Units:
    """Of the model's hysteresis, which need not know them itself."""
    return Units(model.unit, model.input.unit)


def certificate_page(model: Model, found: Certificate, about: Origin) -> str:
    """The whole page (HTML)."""
    label = "TWIN" if model.twin else ""
    sections = [
        Section("Verdict", "Verdict", [verdict_box(found), headline(found), *_left_out(about)]),
        Section("Velocity feedback", "Velocity feedback", [*velocity_parts(found)]),
        Section("Hypotheses", "Hypotheses", [hypotheses_table(found)]),
        Section(
            "Weighting function and set-points", "μ and ψ", [plane_figure(model, found, _words(about), label)]
        ),
        Section("Limits", "Limits", [limits_table(found)]),
        Section("Other loops", "Other loops", [*other_loops(found)]),
        Section("What it rests on", "Provenance", [provenance(about)]),
    ]
    simulated = "the model was identified from a software simulation. No wire was measured."
    title = f"Certificate of {about.model}"
    return page(title, f"{about.file}, identified on {about.rig}", sections, label=label, simulated=simulated)


def certificate_parts(found: Certificate, about: Origin) -> list[Html]:
    """A certificate as part of another page: verdict, table, hypotheses, origin."""
    return [
        verdict_box(found),
        *_left_out(about),
        *velocity_parts(found),
        hypotheses_table(found),
        limits_table(found),
        paragraph(about.sentence()),
    ]


def verdict_box(found: Certificate) -> Html:
    """Passive or not, in a box, with the input that breaks it where there is one."""
    parts = [paragraph(tag("b", symbols(found.verdict)))]
    if found.dissipativity is not None:
        parts.append(paragraph(found.dissipativity.text))
    if found.breaking is not None:
        parts.append(paragraph(found.counter_example))
    return notice(_BOX[found.passive], *parts)


def headline(found: Certificate) -> Html:
    """Classes, storage and bias."""
    c, s = found.classes, found.storage
    inside = (
        joined(["in ", M_P]) if c.M_P else joined(["in ", M_PC, ", not in ", M_P]) if c.M_PC else "neither"
    )
    ground = {
        "positive": "Q_r",
        "recoverable": "Q_r",
        "dissipative": "S_a",
        "none": "none exists",
        "undecided": "not known",
    }[s.ground]
    return cards(
        [
            ("Class of μ", inside, f"g ≥ 0: {'yes' if found.g_not_negative else 'no'}"),
            ("Storage", symbols(ground), _storage_note(s)),
            ("Bias from u(0) = 0", _bias(found), f"begins in {_state(found)}"),
        ]
    )


def _storage_note(s: Storage) -> str:
    if s.ground in ("none", "undecided"):
        return "no function of the state will do" if s.ground == "none" else "not decided"
    why = {"positive": "by Thm 7.4", "recoverable": "proved, although μ < 0 somewhere"}
    return why.get(s.ground, "proved" if s.proved else "known from below only")


def _bias(found: Certificate) -> str:
    if found.storage.ground in ("none", "undecided"):
        return "no bound" if found.storage.ground == "none" else "unknown"
    return f"{number(found.storage.energy)} {exact_unit(found.storage.unit)}"


def _state(found: Certificate) -> str:
    return "B*" if found.initial == "anhysteretic" else "negative saturation"


def symbols(text: str) -> Html:
    """A sentence with its indices set low.

    >>> symbols("k_e < 2")
    'k<sub>e</sub> &lt; 2'
    """
    return Html(_INDEX.sub(r"\1<sub>\2</sub>", escaped(text)))


def velocity_parts(found: Certificate) -> list[Html]:
    """The sentence of Thm 8.2, and k_e of each controller."""
    per = exact_unit(found.units.gain)
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
    header = ("Controller", "Numbers", f"δ ({per})", f"γ ({per})", symbols("k_e"), "Thm 8.2")
    words = (
        "Velocity controllers from ė to ũ: δ from ⟨ė, ũ⟩ ≥ δ‖ė‖², γ from ‖ũ‖ ≤ γ‖ė‖, k_e = max{γ + δ, 1}/δ where "
        "Thm 8.2 covers the loop."
    )
    return [paragraph(symbols(found.loops)), table(header, rows, symbols(words), stacked=True)]


def limits_table(found: Certificate) -> Html:
    """How far the certificate reaches."""
    rows = [(symbols(limit.about), symbols(limit.text)) for limit in found.limits]
    return table(("About", "What holds"), rows, f"How far the certificate reaches; see {FINDINGS}.")


def other_loops(found: Certificate) -> list[Html]:
    """Gains on a schedule, and position controllers."""
    return [paragraph(symbols(found.scheduling)), paragraph(symbols(found.position_controllers))]


def hypotheses_table(found: Certificate) -> Html:
    """Each hypothesis of both theorems, whether it holds, and why."""
    rows = [("Thm 8.1", h.name, _HOLDS[h.holds], symbols(h.why)) for h in found.hypotheses]
    rows += [("Thm 8.2", symbols(h.name), _HOLDS[h.holds], symbols(h.why)) for h in _common(found)]
    return table(
        ("Theorem", "Hypothesis", "Verdict", "Why"),
        rows,
        "Hypotheses, each looked at; those of H₁ hold by construction.",
    )


def _common(found: Certificate) -> list[Hypothesis]:
    return [h for h in found.controllers[0].stability.hypotheses if not h.name.startswith("H₁")]


def _left_out(about: Origin) -> list[Html]:
    return [notice("warning", paragraph(about.left_out().strip()))] if about.effects else []


def _words(about: Origin) -> str:
    rows = sum(r["rows"] for r in about.data)
    return f"Model {about.model}, rig {about.rig}, {len(about.data)} run(s), n = {rows} rows."


def provenance(about: Origin) -> Html:
    """The model file and the runs its data came from, with their hashes."""
    rows: list[tuple[Any, ...]] = [(about.file, "model", "", "", tag("code", about.sha256))]
    rows += [
        (r["run"], r["protocol"].replace("_", " "), r["source"], r["rows"], tag("code", r["sha256"]))
        for r in about.data
    ]
    return table(("File", "What", "Source", "Rows", "SHA-256"), rows, "Model and data.")
