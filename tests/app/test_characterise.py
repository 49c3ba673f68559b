"""A campaign without settled training runs is analysed all the same: only its diagnosis is missing, and why is said."""

from types import SimpleNamespace

from smarig.app.characterise import _try_diagnosis


def test_sweeps_alone_give_a_warning_instead_of_a_diagnosis():
    sweep = SimpleNamespace(settled=())
    plan = SimpleNamespace(step=[SimpleNamespace(label="sweep", purpose="train")])
    found, (warning,) = _try_diagnosis(None, plan, {"sweep": sweep}, print)
    assert found is None
    assert warning.startswith("No diagnosis: it needs settled positions")
    assert "minor_loops" in warning
