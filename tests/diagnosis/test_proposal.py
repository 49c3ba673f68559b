"""The proposed run: the shortest decisive one, otherwise the largest gain per hour; and its campaign file."""

from types import SimpleNamespace

import numpy as np
import pytest

from smarig.app.proposal import DECISIVE_NATS, Proposal, RunOption, _best, propose_run, write_campaign
from smarig.config import CampaignFile
from smarig.core.toml_file import load_toml
from smarig.diagnosis import TEMPERATURE
from smarig.diagnosis.comparison.compared_hypothesis import Part

QUICK = RunOption("wiping_out", {}, 0.5, DECISIVE_NATS + 1)
LONG = RunOption("first_order_descending", {}, 1.2, DECISIVE_NATS + 80)
WEAK = RunOption("congruency", {}, 0.7, 3.0)
STAIRS = RunOption(
    "step_currents", {"profile": "staircase", "settle.window_s": 250.0, "points": 16}, 2.0, 6.0
)


def test_of_runs_that_settle_it_the_quickest_is_proposed():
    assert _best([LONG, QUICK, WEAK]) is QUICK


def test_where_none_settles_it_the_one_that_gains_most_an_hour_is():
    assert _best([STAIRS, WEAK]) is WEAK


def test_the_odds_are_those_the_next_verdict_would_give():
    assert RunOption("wiping_out", {}, 1.0, 0.0).odds == 0.5
    assert RunOption("wiping_out", {}, 1.0, 9 * TEMPERATURE).odds == pytest.approx(1.0, abs=2e-4)


def test_its_campaign_is_one_that_run_takes(tmp_path):
    proposal = Proposal(STAIRS, (STAIRS, WEAK), (("settling",), ("accommodation", "creep")))
    path = tmp_path / "next.toml"
    write_campaign(proposal, path)
    campaign = load_toml(CampaignFile, path)
    (step,) = campaign.step
    assert (step.protocol, step.purpose, step.set) == ("step_currents", "train", STAIRS.settings)
    assert "settling or accommodation + creep" in campaign.summary


def test_the_json_names_what_it_would_separate():
    data = Proposal(QUICK, (QUICK, WEAK), (("walking",), ("fatigue",))).to_json()
    assert data["rivals"] == [["walking"], ["fatigue"]]
    assert data["protocol"] == "wiping_out"
    assert [o["protocol"] for o in data["options"]] == ["wiping_out", "congruency"]
    assert "walking or fatigue" in data["why"]


def diagnosed(**weights):
    """A diagnosis on the one-wire twin with a fitted hypothesis of each effect, as heavy as given."""
    parts = [(Part("effect", name),) for name in weights]
    fitted = SimpleNamespace(plant_model=None, refitted=None)
    return SimpleNamespace(
        model=SimpleNamespace(rig="one_wire_twin", name="wire"),
        found=SimpleNamespace(models=dict.fromkeys(parts, fitted)),
        weights=SimpleNamespace(
            hypotheses=[SimpleNamespace(parts=p) for p in parts], weight=np.array([*weights.values()])
        ),
    )


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "-4.0-False",
        "0.5-False",
    ),
)
@pytest.mark.parametrize(("nats", "worth"), [(-4.0, False), (0.5, False), (5.0, True)])
def test_an_uninformative_run_is_not_proposed(monkeypatch, nats, worth):
    monkeypatch.setattr("smarig.app.proposal._separation_nats", lambda *_: nats)
    said = []
    assert (propose_run(diagnosed(walking=0.6, slip=0.4), said.append) is not None) is worth
    assert any("walking or slip" in line for line in said) is not worth


@pytest.mark.parametrize("left", [{"walking": 1.0}, {"walking": 0.9999, "slip": 1e-4}])
def test_nothing_is_proposed_where_one_hypothesis_is_left(left):
    """Improbable hypotheses are already excluded."""
    said = []
    assert propose_run(diagnosed(**left), said.append) is None
    assert said == ["Nothing is left to be distinguished."]
