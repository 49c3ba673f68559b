"""smarig still gives the answers it gave before it was restructured: a part of them here, all with
SMARIG_LONG=1."""

import os
from collections.abc import Iterable

import pytest

from frozen.answers import Questions, load, wanted
from frozen.comparing import differences

LONG = bool(os.environ.get("SMARIG_LONG"))
SHORT = (
    *(f"box/00/{what}" for what in ("runs", "identify", "verify", "certify", "simulate", "diagnose")),
    *(f"box/05/{what}" for what in ("runs", "identify", "verify", "simulate")),
    *("rig/one_wire_serial", "rig/two_wire_twin", "data/UB199BF", "effect/one_wire/creep"),
    *("effect/one_wire/accommodation", "protocol/one_wire/step_currents", "list"),
    *("python/measure", "python/table", "python/surface", "loop/one_wire/track/inverse/steps"),
)
MOST_SHOWN = 30


def _group(name: str) -> str:
    """Questions that share what they compute."""
    return "/".join(name.split("/")[:2])


def _asked(kept: Iterable[str]) -> list[str]:
    """Old files have a test of their own."""
    return [name for name in wanted(kept, () if LONG else SHORT, LONG) if not name.startswith("old/")]


@pytest.fixture(scope="module")
def kept():
    return load()


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "box/00",
        "data/UB199BF",
        "protocol/one_wire",
    ),
)
@pytest.mark.parametrize("group", sorted({_group(name) for name in (_asked(load()) if LONG else SHORT)}))
def test_the_answers_are_the_same(group, kept, tmp_path):
    questions = Questions(tmp_path)
    names = [name for name in _asked(kept) if _group(name) == group]
    assert names
    if not set(names) <= set(questions.names):
        pytest.skip("no ../shared/data beside the repository, with others' measurements")
    found = [
        line for name in names for line in differences(kept[name], questions.answer(name), name, exact=False)
    ]
    assert not found, "\n".join(found[:MOST_SHOWN])


@pytest.mark.parametrize(
    ("before", "now", "exactly", "about"),
    [
        ({"rms": 1.0}, {"rms": 1.001}, 1, 1),
        ({"rms": 1.0}, {"rms": 1.0 + 1e-9}, 1, 0),
        ({"hash": "a"}, {"hash": "b"}, 1, 0),
        ({"kind": "mark"}, {"kind": "note"}, 1, 1),
        ({"a": 1, "b": 2}, {"a": 1, "c": 2}, 2, 2),
        ([1, 2], [1], 1, 1),
        ({"n": 1}, {"n": True}, 1, 1),
        ({"x": float("nan")}, {"x": float("nan")}, 0, 0),
        (None, {"x": 1}, 1, 1),
    ],
)
def test_a_difference_is_seen(before, now, exactly, about):
    assert len(list(differences(before, now, "it", exact=True))) == exactly
    assert len(list(differences(before, now, "it", exact=False))) == about
