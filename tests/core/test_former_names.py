"""Own files written for earlier versions still load: every former name maps to a present one."""

import importlib

import pytest

from smarig.core.former_names import FORMER, answer_former_names


@pytest.mark.parametrize("former", sorted(FORMER))
def test_a_former_module_has_its_former_names(former):
    answer_former_names()
    present, renamed = FORMER[former]
    home, module = importlib.import_module(present), importlib.import_module(former)
    assert all(getattr(module, old) is getattr(home, new) for old, new in renamed.items())


def test_what_it_never_had_is_an_error():
    answer_former_names()
    with pytest.raises(ImportError):
        from smarig.model.effect import nothing  # noqa: F401


@pytest.mark.parametrize(
    "former", ["smarig.device.wire.register", "smarig.links.modbus_tcp", "smarig.model.heating"]
)
def test_a_module_that_kept_its_name_is_found_below_its_former_package(former):
    answer_former_names()
    assert importlib.import_module(former).__all__


def test_a_star_import_of_a_former_module_brings_former_names():
    answer_former_names()
    names: dict = {}
    exec("from smarig.model.effect import *", names)
    assert {"Kind", "Effect"} <= names.keys()
