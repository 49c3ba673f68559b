"""A certificate states what is proved about its model, and no more, consistently in text, page and JSON."""

import html
import json
import re

import numpy as np
import pytest

from control.measures import table
from control.model_files import model_of
from smarig.certificate.certificate_scope import (
    CertificateScope,
    limits,
    position_controllers,
    position_loops,
    scheduling,
)
from smarig.certificate.certificate_units import Units
from smarig.certificate.certify_hysteresis import certificate
from smarig.certificate.hypothesis import Hypothesis, coverage
from smarig.certificate.passivity import passivity
from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.report.certificate.certificate_page import certificate_page, certificate_units, certified_model

long = pytest.mark.long("takes five seconds")

PROMISES = ("bounds the energy", "does not increase", "stays passive", "covers it")
ONE = {"constant_gain": {"gain": 4.0}}


def sampled(name: str, unit: str) -> FodTable:
    """A surface by its first-order curves on eight levels, as ``--surface table`` makes one."""
    s = thesis_surface(name)
    u = np.linspace(s.lower, s.upper, 8)
    y = s.y_lower + np.array(
        [[s.everett(a, s.lower) - s.everett(a, b) if b <= a else np.nan for b in u] for a in u]
    )
    return FodTable.from_arrays(u, u, y, unit)


def all_texts(hysteresis, controllers=None) -> tuple[str, str, str]:
    """Text, page without its marks, and JSON of one model's certificate."""
    model = model_of("one_e", hysteresis=hysteresis)
    found = certificate(hysteresis, controllers, certificate_units(model))
    page = certificate_page(model, found, certified_model(model, "m.model.json", "0" * 64)).replace(
        "<sub>", "_"
    )
    page, _, _ = page.partition('<aside id="glossary"')  # it defines terms and claims nothing of the model
    page = re.sub(r"<[^>]*>", "", page)
    return found.text, html.unescape(page), json.dumps(found.to_json(), ensure_ascii=False)


@pytest.mark.parametrize(
    "kind", [pytest.param("one_p", marks=long), pytest.param("two_p", marks=long), "table"]
)
def test_what_is_not_dissipative_gets_no_bound(kind):
    hysteresis = sampled("two_p", "deg") if kind == "table" else thesis_surface(kind)
    found = certificate(hysteresis)
    assert found.passive is False
    for words in all_texts(hysteresis):
        assert [promise for promise in PROMISES if promise in words] == []
        assert not re.search(r"k_e = \d", words), "its formula is no promise"
        assert "not covered: passive" in words
        assert "Nothing is proved about them with this model, because this model is not dissipative." in words
        assert "nothing is certified, because this model is not dissipative" in words
    plain = found.to_json()
    assert [c["k_e"] for c in plain["controllers"]] == [None] * len(found.controllers)
    assert all(c["delta"] > 0 for c in plain["controllers"]), "that is the controller's own"


@pytest.mark.long("takes a second")
def test_a_model_that_is_covered_gets_its_bound():
    for words in all_texts(thesis_surface("one_e")):
        assert [promise for promise in PROMISES if promise not in words] == []
    found = certificate(thesis_surface("one_e"), ONE)
    assert found.text.count("k_e = 2.") == 1
    assert found.to_json()["controllers"][0]["k_e"] == 2.0


def test_what_is_not_decided_is_neither_certified_nor_denied():
    scope = CertificateScope("undecided", True, None)
    words = [limit.text for limit in limits(scope)] + [scheduling(scope), position_controllers(scope)]
    assert not [promise for promise in PROMISES for text in words if promise in text]
    assert "not decided whether" in position_loops(scope)
    assert coverage([Hypothesis("passive", None, "open")]) == "not decided: passive is open"
    assert coverage(
        [Hypothesis("a", False, "seen"), Hypothesis("b", False, "seen"), Hypothesis("c", None, "open")]
    ) == ("not covered: a, b fail")


def test_a_dissipative_model_whose_theorem_fails_keeps_its_stored_energy():
    """A relay of negative mass within a larger one: Q_r is no storage function, relays jump, and S_a is what bounds."""
    made = RelayMeasure.from_arrays([0.0, 1.0, 2.0], [-2.0, -2.0, -2.0], [1.0, -0.5, 1.0])
    found = certificate(made, ONE)
    assert (found.storage_bound.basis, found.scope.covered) == ("dissipative", False)
    assert found.controllers[0].k_e is None
    assert "V = S_a(B) + Φ(e) does not increase" in position_loops(found.scope)
    assert "is dissipative" in found.position_controllers


@pytest.mark.long("takes three seconds", cases=("two_p",))
@pytest.mark.parametrize("name", ["one_e", "two_p"])
def test_text_page_and_json_list_the_same_limits(name):
    found = certificate(thesis_surface(name))
    subjects = {limit.about for limit in found.limits}
    assert {"hysteresis alone", "delay and counts", "position loops"} <= subjects
    assert ("units of k_e" in subjects) == ("lag and limits" in subjects) == (name == "one_e")
    words = all_texts(thesis_surface(name))
    for limit in found.limits:
        assert [limit.text in w for w in words] == [True] * 3, limit.about
    assert [limit["text"] for limit in found.to_json()["limits"]] == [limit.text for limit in found.limits]


def test_every_number_of_a_loop_has_its_unit():
    found = certificate(thesis_surface("one_e"), ONE)
    assert "constant_gain: δ = 4 K·s/mm, γ = 4 K·s/mm, k_e = 2." in found.text
    assert "k_e bounds ‖ė‖ in mm/s by ‖ṙ‖ in mm/s + ‖u_o‖ in K" in found.text
    assert found.to_json()["units"] == {
        "output": "mm",
        "input": "K",
        "gain": "K·s/mm",
        "k_e": "bounds ‖ė‖ in mm/s by ‖ṙ‖ in mm/s + ‖u_o‖ in K",
    }
    back = certificate(thesis_surface("two_p"), ONE).text
    assert re.search(r"bring the output back by [0-9.]+ deg,", back)
    assert re.search(r"μ is −[0-9.]+ deg/K² at \(α, β\) = \([^)]*\) K\.", back)


def test_a_table_has_the_units_of_its_model():
    found = certificate(sampled("two_p", "deg"), ONE).to_json()["dissipativity"]
    assert (found["unit"], found["input_unit"]) == ("deg·K", "K")
    assert re.search(r"↔ 185 K gives back [0-9.]+ deg·K in every cycle", found["text"])
    nameless = certificate(table(1), ONE, Units("deg", "K"))
    assert nameless.dissipativity.unit == nameless.storage_bound.unit == "deg·K"
    mirrored = certificate(Mirrored(thesis_surface("one_e")), ONE, Units("mm", "K"))
    assert "at least 0 mm·K" in mirrored.text
    assert "δ = 4, γ = 4, k_e = 2." in certificate(table(1), ONE).text, (
        "and nothing is made up where none is known"
    )


@pytest.mark.parametrize("seed", range(6))
def test_rounding_is_no_energy(seed):
    found = certificate(table(seed), ONE)
    assert found.dissipativity.lower_bound == 0.0
    assert "at least 0)." in found.text
    along = passivity(table(seed), [3.0, -3.0, 2.5, 0.0, 3.0, -3.0, 0.0], "anhysteretic")
    assert "e-" not in along.text


def test_an_energy_within_rounding_reads_zero():
    along = passivity(thesis_surface("one_e"), [50.0, 20.0])
    tiny = type(along)(
        np.array([-9.3e-23, 4.0]),
        0.0,
        along.proven,
        along.basis,
        along.hypotheses,
        along.rounding,
        along.unit,
    )
    assert "minimum along this run is 0 mm·K (sample 0)" in tiny.text


def test_a_failing_hypothesis_is_a_sentence():
    assert (
        Hypothesis("output follows input", False, "it does not").text
        == "Output follows input: no, it does not."
    )
    assert Hypothesis("ν ≥ 0", None, "nobody looked").text == "ν ≥ 0: not decided, nobody looked."
    assert not re.search(r"[.:] [a-z ]+: fails", certificate(thesis_surface("two_p")).text)


@pytest.mark.parametrize("name", ["inverse", "pi", "gain_scheduled"])
def test_a_position_loop_is_refused_by_what_it_is(name):
    with pytest.raises(UsageError, match=r"is a position loop \(.*control_findings\.md"):
        certificate(thesis_surface("one_e"), {name: {}})


def test_a_model_without_hysteresis_is_not_called_passive():
    nodes = np.linspace(0.0, 10.0, 6)
    found = certificate(FodTable(nodes, np.tile(nodes**2, (6, 1))), {})
    assert not found.has_hysteresis
    assert found.passive is None
    assert found.verdict.startswith("Not decided: this model has no hysteresis")
    assert certificate(thesis_surface("one_c"), {}).has_hysteresis
