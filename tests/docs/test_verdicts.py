"""The thresholds of verdicts stand in the reference and in the help of verify as the code has them."""

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from smarig.cli.commands.verify import command
from smarig.identification import (
    GOOD_RATIO,
    POOR_RATIO,
    AgainstCurves,
    error_verdict,
    study_sentences,
    threshold_sentences,
)
from smarig.report.components.glossary import terms, terms_in

PAGE = Path(__file__).parents[2] / "docs/reference/verdicts.md"


def plain(text):
    return re.sub(r"\s+", " ", text)


@pytest.mark.parametrize("sentence", [*threshold_sentences(), *study_sentences()])
def test_the_reference_states_each_threshold(sentence):
    assert sentence in plain(PAGE.read_text(encoding="utf-8"))


@pytest.mark.parametrize("sentence", threshold_sentences())
def test_the_help_of_verify_states_each_threshold(sentence):
    assert sentence in plain(CliRunner().invoke(command, ["--help"]).output)


def test_the_glossary_of_pages_states_them_and_is_reached_from_a_verdict():
    meaning = next(term.meaning for term in terms() if term.name == "error verdict")
    assert f"at most {GOOD_RATIO:g}, at most {POOR_RATIO:g}, or more" in meaning
    for ratio in (1.0, 2.0, 9.0):
        found = error_verdict(ratio, 1.0, 0.0).text
        assert "error verdict" in [term.name for term in terms_in(f"<p>{found}</p>")], found


@pytest.mark.parametrize(
    ("ratio", "level"),
    [(GOOD_RATIO, "good"), (1.01 * GOOD_RATIO, "fair"), (POOR_RATIO, "fair"), (1.01 * POOR_RATIO, "poor")],
)
def test_levels_change_where_the_sentences_say(ratio, level):
    assert error_verdict(ratio, 1.0, 0.0).level == level


@pytest.mark.parametrize(("gain", "level"), [(1.6, "good"), (1.3, "fair"), (1.1, "poor")])
def test_a_study_compares_with_curves_even_at_the_noise_floor(gain, level):
    assert "good only if the error of every simple curve is at least 1.5 ×" in plain(
        PAGE.read_text(encoding="utf-8")
    )
    assert error_verdict(1.0, 1.0, 0.02, curves=AgainstCurves(gain)).level == level
