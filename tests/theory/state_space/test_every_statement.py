"""Chapter 6, statement by statement: the test of each, and the test of its violation by a counterexample.

Every name below must be a test of this folder, so the list cannot become outdated.
"""

import re
from pathlib import Path

import pytest

HERE = Path(__file__).parent

# statement: (file, beginning of the test's name, beginning of the name of the test that plants a violation)
STATEMENTS = {
    "Def. 6.1 (1) inputs closed under shift": (
        "axioms",
        "def_6_1_axiom_1_",
        "def_6_1_axiom_1_counterexample",
    ),
    "Def. 6.1 (2) output space": ("axioms", "def_6_1_axiom_2_", "def_6_1_axiom_2_counterexample"),
    "Def. 6.1 (3) state space, Def. 6.2 (BP1–BP3)": ("boundaries", "def_6_2_every", "def_6_2_counterexample"),
    "Def. 6.1 (4a) consistency": ("axioms", "def_6_1_axiom_4a_", "def_6_1_axiom_4a_counterexample"),
    "Def. 6.1 (4b) determinism": ("axioms", "def_6_1_axiom_4b_", "def_6_1_axiom_4b_counterexample"),
    "Def. 6.1 (4c) semi-group": ("axioms", "def_6_1_axiom_4c_", "def_6_1_axiom_4c_counterexample"),
    "Def. 6.1 (4d) stationarity, (6.9)": ("axioms", "def_6_1_axiom_4d_", "def_6_1_axiom_4d_counterexample"),
    "Def. 6.1 (5) read-out": ("axioms", "def_6_1_axiom_5_", "def_6_1_axiom_5_counterexample"),
    "Def. 6.1 (6) outputs are restrictions": ("axioms", "def_6_1_axiom_6_", "def_6_1_axiom_6_counterexample"),
    "§6.2.3 zero element": ("boundaries", "zero_element_is", "zero_element_counterexample"),
    "Erratum 12 zero output in B*": ("boundaries", "erratum_12_zero", "erratum_12_counterexample"),
    "Erratum 10 B_ℓ along the edge": ("boundaries", "erratum_10_completed", "erratum_10_counterexample"),
    "Def. 6.3 reachability, ℬⁿ, ℬ_r": ("reachability", "def_6_3_boundaries", "def_6_3_counterexample"),
    "(6.1) reduced memory sequence": ("memory_sequences", "eq_6_1_reduced", "eq_6_1_counterexample"),
    "(6.2) limit": ("memory_sequences", "eq_6_2_a", "eq_6_2_counterexample"),
    "(6.3) N(s)": ("memory_sequences", "eq_6_3_N", "eq_6_3_counterexample"),
    "Def. 6.4 space of sequences": ("memory_sequences", "def_6_4_what", "def_6_4_counterexample"),
    "(6.4) partition, erratum 2": ("maps", "eq_6_4_corrected", "eq_6_4_counterexample"),
    "(6.5) input through a sequence": ("maps", "eq_6_5_input", "eq_6_5_counterexample"),
    "Lemma 6.1 (1) right inverse": (
        "maps",
        "lemma_6_1_property_1_right",
        "lemma_6_1_property_1_counterexample",
    ),
    "Lemma 6.1 (2) deterministic": (
        "maps",
        "lemma_6_1_property_2_det",
        "lemma_6_1_property_2_counterexample",
    ),
    "Lemma 6.1 (3) continuity": ("maps", "lemma_6_1_property_3_the", "lemma_6_1_property_3_counterexample"),
    "Lemma 6.1 (4), (6.6)": ("maps", "lemma_6_1_property_4_eq", "lemma_6_1_property_4_counterexample"),
    "G: corners": ("maps", "G_has_the_corners", "G_counterexample_corners"),
    "G: p_N, erratum 10": ("maps", "G_separates_the_relays", "G_counterexample_erratum_10"),
    "G G⁻¹ = G⁻¹ G = I": ("maps", "G_and_its_inverse", "G_counterexample_inverse"),
    "Ra(G)": ("maps", "range_of_G_is", "range_of_G_counterexample"),
    "Lemma 6.2 (1) left inverse": (
        "maps",
        "lemma_6_2_property_1_left",
        "lemma_6_2_property_1_counterexample",
    ),
    "Lemma 6.2 (2) deterministic": (
        "maps",
        "lemma_6_2_property_2_det",
        "lemma_6_2_property_2_counterexample",
    ),
    "Lemma 6.2 (3), (6.7)": ("maps", "lemma_6_2_property_3_eq", "lemma_6_2_property_3_counterexample"),
    "Def. 6.5 admissible inputs": ("transition", "def_6_5_inputs", "def_6_5_counterexample"),
    "(6.8) state transition": ("transition", "eq_6_8_is_what", "eq_6_8_counterexample"),
    "§6.4.3 read-out": ("read_out", "read_out_is_the_output", "read_out_counterexample"),
    "§6.4.3 P₊, P₋": ("read_out", "P_plus_and_P_minus", "P_plus_counterexample"),
    "Claim 6.3 (B̃P1–B̃P3)": ("metric", "claim_6_3_turned", "claim_6_3_counterexample"),
    "(6.10) turning back": ("metric", "eq_6_10_turning", "eq_6_10_counterexample"),
    "§6.5.1 metric": ("metric", "area_is_a_metric", "area_counterexample"),
    "(6.11) area as L₁ distance": ("metric", "eq_6_11_is_the_area", "eq_6_11_counterexample"),
    "§6.5.1 no linear space": ("metric", "turned_boundaries_are_no", "turned_boundaries_counterexample"),
    "Def. 6.6, Theorem 6.4": ("reachability", "theorem_6_4_every", "theorem_6_4_counterexample"),
    "Def. 6.7, §6.5.3 boundedness": ("metric", "boundedness_def_6_7", "boundedness_counterexample"),
    "Def. 6.8 Cauchy, 6.9 complete, Theorem 6.7": (
        "metric",
        "theorem_6_7_cauchy",
        "theorem_6_7_counterexample",
    ),
    "Def. 6.10, Lemma 6.5 equicontinuity": ("metric", "lemma_6_5_equi", "lemma_6_5_counterexample"),
    "Theorem 6.6 as it is used": ("metric", "theorem_6_6_what", "theorem_6_6_counterexample"),
}


def names_in(file: str) -> list[str]:
    return re.findall(
        r"^def test_(\w+)", (HERE / f"test_{file}.py").read_text(encoding="utf-8"), re.MULTILINE
    )


@pytest.mark.parametrize("statement", STATEMENTS)
def test_statement_has_its_test_and_its_counterexample(statement):
    file, law, counterexample = STATEMENTS[statement]
    names = names_in(file)
    assert any(name.startswith(law) and "counterexample" not in name for name in names)
    assert any(name.startswith(counterexample) for name in names)


def test_a_statement_without_a_test_would_be_missed():
    assert not any(name.startswith("theorem_6_8") for name in names_in("metric"))
