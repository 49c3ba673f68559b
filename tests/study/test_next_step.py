"""What a study recommends: the run that would tell most, or what the model can be used for."""

from types import SimpleNamespace

import numpy as np
import pytest

from smarig.study import StudyOptions, next_step, study


def result(word="silent", names=(), depends_on=None, *, verdict="fair", inner="fitted", extended=False):
    verdict_of = SimpleNamespace(word=word, names=names, depends_on=depends_on)
    return SimpleNamespace(
        evaluation=object(),
        function=None,
        undetermined=None,
        diagnosis=SimpleNamespace(verdict=verdict_of, extended=extended),
        verdict=verdict,
        inner_loops=inner,
        goes_one_way=False,
        tables=[],
    )


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (result("unknown", depends_on="rate"), "half the rate"),
        (result("unknown", depends_on="time"), "at rest"),
        (result("named", ("input_lag",)), "a slower run"),
        (result("named", ("input_lag",), extended=True), "model.json"),
        (result("ambiguous", ("ratcheting", "output_drift")), "To separate these causes"),
        (result(verdict="good"), "model.json"),
        (result(verdict="good", inner="none"), "reversal curves"),
        (result(verdict="poor"), "Repeat the run unchanged"),
        (result(verdict="poor", inner="held out"), "Repeat the run unchanged"),
    ],
)
def test_the_step_follows_from_what_is_known(found, words):
    step = next_step(found)
    assert words in step
    assert step.endswith(".")


@pytest.mark.parametrize("key", ["function", "undetermined"])
def test_what_other_sentences_say_is_not_said_again(key):
    found = result()
    setattr(found, key, object())
    assert next_step(found) == ""


def test_text_page_and_json_have_it(tmp_path):
    t = np.arange(0, 1200.0, 2.0)
    u = 20 + 70 * (1 - np.abs((t % 300) / 150 - 1))
    y, held = [], u[0]
    for v in u:  # a play
        held = min(max(held, v - 8), v + 8)
        y.append(held / 20)
    file = tmp_path / "loop.csv"
    noisy = np.array(y) + 0.002 * np.random.default_rng(2).standard_normal(t.size)
    rows = np.column_stack([t, u, noisy])
    np.savetxt(
        file, rows, delimiter=",", header="time_s,temperature_C,displacement_mm", comments="", fmt="%.5f"
    )
    found = study([file], tmp_path / "out", StudyOptions(diagnose=False))
    step = next_step(found)
    assert "reversal curves" in step
    assert found.to_json()["next_step"] == step
    assert "<b>Next: </b>" in (tmp_path / "out" / "index.html").read_text()


@pytest.mark.parametrize(("variable", "verdict"), [("run", "fair"), ("run", "poor"), ("rate", "poor")])
def test_where_a_condition_differs_the_same_run_is_not_repeated(variable, verdict):
    found = result("unknown", depends_on=variable, verdict=verdict)
    runs = [{"load": {"mean": mean, "unit": "N"}} for mean in (1.0, 5.0)]
    found.tables = [SimpleNamespace(run=SimpleNamespace(info=SimpleNamespace(conditions=c))) for c in runs]
    assert next_step(found) == "Study the runs of each load by themselves: one model cannot follow them all."
    found.tables = found.tables[:1]
    assert ("another day" if variable == "run" else "half the rate") in next_step(found)


def test_a_branch_alone_needs_the_way_back():
    found = result("unknown", depends_on="rate")
    found.goes_one_way = True
    assert "way back" in next_step(found)
