"""The stub has the names, arguments and errors of the real package nidaqmx, where that is installed."""

import importlib
import inspect

import pytest

from device.ni import stub_nidaqmx as stub

METHODS = {
    "nidaqmx.Task": (stub.Task, ("start", "read", "write", "close")),
    "nidaqmx.task.collections.AOChannelCollection": (stub.AOChannelCollection, ("add_ao_voltage_chan",)),
    "nidaqmx.task.collections.AIChannelCollection": (
        stub.AIChannelCollection,
        ("add_ai_voltage_chan", "add_ai_thrmcpl_chan"),
    ),
    "nidaqmx.task.collections.CIChannelCollection": (stub.CIChannelCollection, ("add_ci_ang_encoder_chan",)),
    "nidaqmx.task.collections.COChannelCollection": (
        stub.COChannelCollection,
        ("add_co_pulse_chan_freq",),
    ),
    "nidaqmx.task._timing.Timing": (stub.Timing, ("cfg_samp_clk_timing", "cfg_implicit_timing")),
    "nidaqmx.system.WatchdogTask": (
        stub.WatchdogTask,
        ("__init__", "cfg_watchdog_ao_expir_states", "start", "reset_timer", "clear_expiration", "close"),
    ),
}


@pytest.fixture(autouse=True)
def real():
    pytest.importorskip("nidaqmx", reason="the package nidaqmx is not installed")


def found(path):
    module, name = path.rsplit(".", 1)
    return getattr(importlib.import_module(module), name)


@pytest.mark.parametrize("path", METHODS)
def test_arguments(path):
    cls, methods = METHODS[path]
    for method in methods:
        mine = inspect.signature(getattr(cls, method)).parameters
        theirs = inspect.signature(getattr(found(path), method)).parameters
        assert set(mine) <= set(theirs), method
        positional = [n for n, p in mine.items() if p.kind is p.POSITIONAL_OR_KEYWORD]
        assert positional == list(theirs)[: len(positional)], method


@pytest.mark.parametrize("name", vars(stub.constants))
def test_constants(name):
    theirs = getattr(importlib.import_module("nidaqmx.constants"), name)
    if isinstance(theirs, int):
        assert theirs == getattr(stub.constants, name)
        return
    assert {m.name for m in getattr(stub.constants, name)} <= {m.name for m in theirs}


def test_the_rest():
    errors = importlib.import_module("nidaqmx.errors")
    assert issubclass(errors.DaqError, errors.Error)
    assert issubclass(errors.DaqNotFoundError, errors.Error)
    assert found("nidaqmx.types.AOExpirationState")._fields == stub.AOExpirationState._fields
    for name in ("product_type", "serial_num"):
        assert isinstance(inspect.getattr_static(found("nidaqmx.system.Device"), name), property)
    for name in ("expired", "timeout"):
        assert isinstance(inspect.getattr_static(found("nidaqmx.system.WatchdogTask"), name), property)
    for name in ("ai_channels", "ao_channels", "ci_channels", "co_channels", "timing"):
        assert isinstance(inspect.getattr_static(found("nidaqmx.Task"), name), property)
