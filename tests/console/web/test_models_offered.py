"""Over the loop of a run, only models in its own unit are offered and drawn."""

from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("starlette", reason="the extra console is not installed")

from smarig.console.web.pages import live_run_page
from smarig.core import UsageError

ENTRIES = [
    SimpleNamespace(place="one.model.json", path=Path("one.model.json"), details={"unit": "mm"}),
    SimpleNamespace(place="two.model.json", path=Path("two.model.json"), details={"unit": "deg"}),
    SimpleNamespace(place="old.model.json", path=Path("old.model.json"), details={}),
]


@pytest.fixture(autouse=True)
def library(monkeypatch):
    found = SimpleNamespace(search=lambda **_: SimpleNamespace(entries=ENTRIES))
    monkeypatch.setattr(live_run_page, "context_of", lambda _: SimpleNamespace(library=found))


def request_of(model=""):
    return SimpleNamespace(query_params={"model": model})


@pytest.mark.parametrize(
    ("unit", "offered"), [("mm", ["one", "old"]), ("deg", ["two", "old"]), (None, ["one", "two", "old"])]
)
def test_models_of_another_unit_are_not_offered(unit, offered):
    run = SimpleNamespace(info={"unit": unit})
    assert [e.place.split(".")[0] for e in live_run_page._models(request_of(), run)] == offered


def test_a_model_of_another_unit_in_the_address_is_refused():
    run = SimpleNamespace(info={"unit": "deg"})
    assert live_run_page._model(request_of("two.model.json"), run) == Path("two.model.json")
    assert live_run_page._model(request_of(), run) is None
    with pytest.raises(UsageError, match="no such model in deg"):
        live_run_page._model(request_of("one.model.json"), run)
