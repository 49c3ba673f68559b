"""Diagnoses in which few effects compete: what they find has tests of its own, pages show any."""

import contextlib
from collections.abc import Iterator
from functools import partial
from importlib import import_module

import pytest

from smarig.diagnosis import diagnose_commanded
from smarig.plant.effect_catalogue import effect_types

COMPETE = ("ambient_drift", "creep", "slip", "walking")


@contextlib.contextmanager
def few_effects() -> Iterator[None]:
    """What ``characterise`` diagnoses, with few effects."""
    without = [k.name for k in effect_types() if k.name not in COMPETE]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            import_module("smarig.app.characterise"),
            "diagnose_commanded",
            partial(diagnose_commanded, without=without),
        )
        yield
