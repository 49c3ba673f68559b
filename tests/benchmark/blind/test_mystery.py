"""The table of the mystery benchmark: right, wrong and open answers, and the seeds it uses."""

from types import SimpleNamespace

import pytest

from benchmarks import mystery
from smarig.core.errors import UsageError


def answer(word, names=(), invisible=()):
    return SimpleNamespace(verdict=SimpleNamespace(word=word, names=names), not_identifiable=invisible)


@pytest.mark.parametrize(
    ("found", "hidden", "outcome"),
    [
        (answer("silent"), [], "right"),
        (answer("silent"), ["walking"], "open"),
        (answer("not_identifiable", invisible=("creep",)), ["creep"], "right"),
        (answer("named", ("walking",)), ["walking"], "right"),
        (answer("named", ("slip",)), ["walking"], "wrong"),
        (answer("named", ("slip", "walking")), ["walking"], "wrong"),
        (answer("ambiguous", ("slip", "walking")), ["walking"], "open"),
        (answer("unknown"), ["walking"], "open"),
        (answer("unknown"), [], "wrong"),
        (answer("ambiguous", ("slip", "walking")), [], "wrong"),
    ],
)
def test_the_outcome_depends_on_what_was_hidden(found, hidden, outcome):
    assert mystery.outcome(found, hidden) == outcome


def test_shares_are_of_all_requested_seeds(monkeypatch):
    outcomes = {7: "right", 8: "open", 9: "wrong", 10: "right"}
    monkeypatch.setattr(mystery, "solve_seed", lambda seed: {"seed": seed, "outcome": outcomes[seed]})
    found = mystery.run(boxes=4, seed=7)
    assert (found["right"], found["wrong"]) == (0.5, 0.25)
    assert [row["seed"] for row in found["rows"]] == [7, 8, 9, 10]


@pytest.mark.parametrize("wrong", [{"boxes": 0}, {"workers": 0}])
def test_no_seeds_or_no_workers_are_refused(wrong):
    with pytest.raises(UsageError, match="At least one"):
        mystery.run(**wrong)
