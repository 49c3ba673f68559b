"""Every number of actuator and rig files at absurd values: refused in a sentence, or a twin that runs."""

import copy
import math

import pytest
from pydantic import ValidationError

from smarig.config import ActuatorFile, RigFile, load_actuator, load_rig
from smarig.core import SmarigError
from smarig.plant import Actuator, thermomechanical_travel
from smarig.rig.twin import Twin, TwinSettings

ABSURD = (0, -1, 1e-300, 1e300, 1e-5, 1e5, math.nan, math.inf)
RIGS = ("one_wire_twin", "two_wire_twin", "one_wire_thermomechanical", "two_wire_thermomechanical")
INTERNAL = (
    "cannot convert",
    "overflow",
    "math domain",
    "division",
    "complex",
)  # of Python, not of this package


def numbers(table, path=()):
    for key, value in table.items():
        if isinstance(value, dict):
            yield from numbers(value, (*path, key))
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield *path, key


def changed(table, path, value):
    table = copy.deepcopy(table)
    inner = table
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    return table


def tried(rig, actuator):
    """The error of a twin of these tables in a few ticks, "" if it runs."""
    try:
        file, wire = RigFile.model_validate(rig), Actuator(ActuatorFile.model_validate(actuator))
        twin = Twin(file, wire, TwinSettings(seed=1))
        samples = [twin.step(i)[0] for i in (0.0, 0.3, 1.0, 1.0, 1.0, 0.2)]
        if wire.file.thermomechanical:
            assert math.isfinite(thermomechanical_travel(wire))
    except (ValidationError, SmarigError) as error:
        return str(error)
    assert all(math.isfinite(s.position) and math.isfinite(s.voltage_V) for s in samples)
    return ""


@pytest.mark.long("takes three seconds", cases=("two_wire_thermomechanical",))
@pytest.mark.parametrize("name", RIGS)
def test_every_number_is_refused_or_runs(name):
    rig = load_rig(name).model_dump(mode="json")
    actuator = load_actuator(rig["actuator"]).model_dump(mode="json")
    assert tried(rig, actuator) == ""
    refused = 0
    for path in numbers(actuator):
        for value in ABSURD:
            error = tried(rig, changed(actuator, path, value))
            assert not any(words in error for words in INTERNAL), (path, value, error)
            refused += bool(error)
    for path in numbers(rig):
        for value in ABSURD:
            error = tried(changed(rig, path, value), actuator)
            assert not any(words in error for words in INTERNAL), (path, value, error)
            refused += bool(error)
    assert refused > 100


def test_values_possible_alone_that_make_no_wire_together():
    tables = load_actuator("gorbet_one_wire").model_dump(mode="json")
    tables["wire"]["diameter"]["value"] = tables["wire"]["active_length"]["value"] = 1e4
    with pytest.raises(ValidationError, match="give a thermal time constant of"):
        ActuatorFile.model_validate(tables)
