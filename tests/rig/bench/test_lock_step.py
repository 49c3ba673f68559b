"""The bench over real bytes equals the twin in process, sample by sample: one clock, one wire, one noise.

Two wires on each link, thermomechanical ones, and the firmware over lines, only with ``SMARIG_LONG=1``.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from firmware.firmware_build import make
from smarig.config import load_rig
from smarig.record import load_run
from smarig.runner.session import Session

COLUMNS = (
    *("tick", "step", "current_command_A", "current_A", "voltage_V", "counts", "position"),
    *("ambient_degC", "quality", "input"),
)
where_there_is_time = pytest.mark.long("takes five seconds")
LINKS = ("serial", "modbus_tcp", "modbus_rtu")
RIGS = [
    *(("one", link) for link in LINKS),
    *(pytest.param("two", link, marks=where_there_is_time) for link in LINKS),
]


def record(rig, folder):
    """Two runs of one session with the encoder zeroed in between."""
    with Session(rig, seed=3, wire=f"lock step {Path(rig).name}") as session:
        return [
            load_run(session.run("validation", {"points": 3}, folder / f"{k}.run.sqlite", force=True))
            for k in range(2)
        ]


@pytest.fixture(scope="module")
def twin(tmp_path_factory):
    """Both runs of a twin; they are made when they are asked for."""
    return cache(lambda arrangement: record(f"{arrangement}_wire_twin", tmp_path_factory.mktemp(arrangement)))


@pytest.mark.long("takes five seconds", cases=("one-modbus_tcp", "one-serial"))
@pytest.mark.parametrize(("arrangement", "link"), RIGS)
def test_bytes_make_no_difference(twin, arrangement, link, tmp_path):
    same(twin(arrangement), record(f"{arrangement}_wire_{link}", tmp_path))


@pytest.mark.parametrize(
    "arrangement", [pytest.param(name, marks=where_there_is_time) for name in ("one", "two")]
)
def test_bytes_make_no_difference_to_a_thermomechanical_wire(arrangement, tmp_path):
    rig, limits = (
        f"{arrangement}_wire_thermomechanical",
        load_rig(f"{arrangement}_wire_thermomechanical").limits,
    )
    bench = tmp_path / "bench.toml"
    bench.write_text(
        f'name = "bench"\nbase = "{arrangement}_wire_serial"\nactuator = "thermomechanical_{arrangement}_wire"\n'
        f"[limits]\ncurrent_max_A = {limits.current_max_A}\ntemperature_max_K = {limits.temperature_max_K}\n"
    )
    folders = [tmp_path / name for name in ("twin", "bytes")]
    for folder in folders:
        folder.mkdir()
    same(record(rig, folders[0]), record(str(bench), folders[1]))


def same(twins, benches):
    """Every column and every step."""
    for twin, bench in zip(twins, benches, strict=True):
        assert np.ptp(twin["position"]) > 3, "it moves"
        for name in COLUMNS:
            np.testing.assert_array_equal(bench[name], twin[name], err_msg=name)
        assert [(s.position, s.n, s.verdict) for s in bench.steps] == [
            (s.position, s.n, s.verdict) for s in twin.steps
        ]
        assert bench.twin, "simulated devices are a twin"


@pytest.mark.parametrize("framing", [pytest.param("lines", marks=where_there_is_time), "modbus_rtu"])
def test_the_firmware_built_for_this_machine_makes_no_difference(twin, framing, tmp_path, tmp_path_factory):
    library = make(tmp_path_factory.mktemp("firmware"), "libsmarig_firmware.so", ("gcc",))
    base = "one_wire_serial" if framing == "lines" else "one_wire_modbus_rtu"
    rig = tmp_path / "firmware.toml"
    rig.write_text(f'name = "firmware"\nbase = "{base}"\n[simulator]\nlibrary = "{library}"\n')
    same(twin("one"), record(str(rig), tmp_path))


def test_a_rig_that_extends_another_holds_only_its_own_keys():
    twin, bench = load_rig("one_wire_twin"), load_rig("one_wire_serial")
    assert (bench.limits, bench.encoder, bench.actuator) == (twin.limits, twin.encoder, twin.actuator)
    assert (bench.kind, bench.lease_s) == ("bench", 2.0)
