"""What lies between runs: which run is shifted against which, a drift as the rival of an offset, and adequacy."""

from types import SimpleNamespace

import numpy as np
import pytest

from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.measured import measured_comparison
from smarig.diagnosis.comparison.measured.measured_comparison import RunOffset, drifting
from smarig.diagnosis.comparison.measured.measured_text import offset_sentence
from smarig.diagnosis.comparison.verdict_rules import VerdictEvidence, decide

OFFSET, DRIFT, LAG = (Part("effect", n) for n in ("input_offset", "input_drift", "input_lag"))


def shifted(run: str, offset: float, *, held_out: bool) -> RunOffset:
    return RunOffset(run, offset, (offset - 1, offset + 1), 0.4, 0.1, "monday", held_out)


def test_a_shifted_training_run_is_not_called_held_out() -> None:
    said = [offset_sentence(shifted("tuesday", -2.0, held_out=h), "V", "mm") for h in (False, True)]
    assert "training run tuesday is shifted by 2 [1, 3] V along the input against monday:" in said[0]
    assert "held-out run tuesday" in said[1]


def test_offsets_say_which_run_is_held_out_and_put_it_first(monkeypatch: pytest.MonkeyPatch) -> None:
    names = ["monday", "tuesday", "friday"]
    monkeypatch.setattr(measured_comparison, "interval", lambda *_: (-9.0, 9.0))
    problem = SimpleNamespace(
        scale=-1.0, record=np.array([0, 1, 2]), records=[SimpleNamespace(name=n) for n in names]
    )
    fit = SimpleNamespace(problem=problem, error=np.array([0.1, 0.2, 0.3]))
    best = SimpleNamespace(state=fit, parameters={"tuesday": 1.0, "friday": 2.0})
    nothing, single = (
        SimpleNamespace(name=n, best=best, parts=(OFFSET,)) for n in ("nothing", "input_offset")
    )
    weights = SimpleNamespace(hypotheses=(nothing, single), causes={OFFSET: 0.99})
    wires = [SimpleNamespace(record=r, held_out=np.array([r.name == "friday"])) for r in problem.records]
    found = measured_comparison._offsets(weights, wires)
    assert [(o.run, o.held_out, o.against) for o in found] == [
        ("friday", True, "monday"),
        ("tuesday", False, "monday"),
    ]


def between(causes: dict[Part, float], drift: float) -> VerdictEvidence:
    """Evidence between runs; ``drift`` is the weight of the offset together with a drift."""
    return VerdictEvidence(
        causes=causes,
        nothing=0.0,
        size=dict.fromkeys(causes, 0.1),
        span=1.0,
        error=0.1,
        noise=0.01,
        blocks=20,
        together={frozenset((OFFSET, DRIFT)): drift, frozenset((OFFSET,)): 1.0 - drift},
    )


@pytest.mark.parametrize(
    ("drift", "names"), [(0.2, {"input_offset"}), (0.95, {"input_offset", "input_drift"})]
)
def test_an_offset_is_no_name_where_the_runs_drift(drift: float, names: set[str]) -> None:
    """A drift that goes on between the runs shifts each against the one before."""
    found = decide(drifting(between({OFFSET: 0.99, DRIFT: drift, LAG: 0.0}, drift)))
    assert set(found.names) == names
    assert found.word == ("named" if len(names) == 1 else "ambiguous")
