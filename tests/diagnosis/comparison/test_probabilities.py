"""What a verdict says of its causes and the probabilities that it states are one."""

from collections import namedtuple

import pytest

from smarig.diagnosis import Part
from smarig.diagnosis.comparison.probabilities import WITHHELD, probabilities
from smarig.diagnosis.comparison.verdict_rules import Verdict

LAG, DRIFT, TIME = Part("effect", "wire_lag"), Part("effect", "ambient_drift"), Part("variable", "time")
weighed = namedtuple("weighed", ("causes", "nothing"))
WEIGHTS = {LAG: 0.95, DRIFT: 0.2, TIME: 0.04}


@pytest.mark.parametrize("word", ["named", "ambiguous"])
def test_what_is_named_keeps_its_weight(word):
    stated = probabilities(Verdict(word, "likely", ("wire_lag",)), weighed(WEIGHTS, 0.01))
    assert stated.causes == WEIGHTS
    assert stated.outside == 0.0
    assert stated.nothing == 0.01


@pytest.mark.parametrize("word", ["unknown", "silent"])
def test_what_is_withheld_may_be_a_cause_outside_the_catalogue(word):
    stated = probabilities(Verdict(word, "with_others"), weighed(WEIGHTS, 0.01))
    assert stated.causes[LAG] == pytest.approx(WITHHELD * 0.95)
    assert stated.causes[TIME] == 0.04  # which describes, whatever the cause
    assert stated.outside == pytest.approx((1 - WITHHELD) * 0.95)
    assert stated.causes[LAG] + stated.outside + stated.nothing <= 1.0


def test_the_likeliest_comes_first():
    stated = probabilities(Verdict("unknown", "shared"), weighed({LAG: 0.5, TIME: 0.45}, 0.05))
    assert next(iter(stated.causes)) == TIME


def test_nothing_leaves_no_room_for_what_is_outside():
    assert probabilities(Verdict("silent", "nothing"), weighed({LAG: 0.0}, 1.0)).outside == 0.0
