"""``smarig new``: every template works unchanged, and nothing is overwritten."""

import json
import os

import numpy as np
import pytest

from control.model_files import model_file
from plant.effects.driven import driven
from smarig.cli import run as cli
from smarig.config import load_actuator, load_campaign, load_rig
from smarig.core.catalogue import catalogue_entry, own_files, resolve_name
from smarig.plant.effect_catalogue import EFFECTS
from smarig.rig.consistency import DRIVERS, inconsistencies
from smarig.rig.twin import Twin

KINDS = ("rig", "actuator", "protocol", "controller", "effect", "driver", "campaign")


def call(capsys, *arguments):
    status = cli([str(a) for a in arguments])
    out, err = capsys.readouterr()
    return status, out, err


@pytest.fixture
def made(capsys, tmp_path, monkeypatch):
    """One of each, called first_KIND."""
    monkeypatch.chdir(tmp_path)
    files = {}
    for kind in KINDS:
        status, out, _ = call(capsys, "new", kind, f"first_{kind}", "--json")
        found = json.loads(out)
        assert (status, found["kind"], found["name"]) == (0, kind, f"first_{kind}")
        files[kind] = tmp_path / found["file"]
    with own_files():
        yield files


def test_nothing_is_left_of_the_name_it_had(made):
    assert [f"my_{kind}" for kind, file in made.items() if f"my_{kind}" in file.read_text()] == []


def test_the_rig_opens_as_a_twin(capsys, made):
    status, out, _ = call(capsys, "check", "./first_rig.toml", "--json")
    assert status == 0
    assert json.loads(out)["lease_trips"] is True
    assert Twin.named(str(made["rig"])).step(0.5)


def test_the_rig_becomes_a_bench_by_uncommenting_lines(made):
    text = made["rig"].read_text().replace('kind = "twin"', 'kind = "bench"').replace('"/dev/', '"/tmp/')
    head, _, tail = text.partition("# --- hardware")
    bench = "\n".join(line.removeprefix("# ") for line in tail.splitlines()[1:] if "[simulator]" not in line)
    made["rig"].write_text(head + bench.replace("#\n", "\n"))
    assert inconsistencies(load_rig(str(made["rig"]))) == []


def test_the_actuator_is_found_in_the_folder_of_the_rig(capsys, made, tmp_path, monkeypatch):
    assert load_actuator(str(made["actuator"])).name == "first_actuator"
    rig = made["rig"].read_text().replace('"gorbet_one_wire"', '"./first_actuator.toml"')
    made["rig"].write_text(rig)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    status, out, err = call(capsys, "check", "../first_rig.toml", "--json")
    assert status == 0
    assert json.loads(out)["actuator"] == "first_actuator"
    (warning,) = err.splitlines()
    assert "first_actuator still has values of the template" in warning
    assert "wire.diameter, wire.active_length, heating.resistance_martensite" in warning
    assert "transmission.radius. Replace each" in warning
    assert "density" not in warning, "its source is typical NiTi"
    file = made["actuator"]
    file.write_text(file.read_text().replace('"replace: ', '"measured: '))
    assert call(capsys, "check", "../first_rig.toml")[2] == ""


def test_the_protocol_runs(capsys, made):
    settings = ["--set", "loops=1", "--set", "points=2"]
    status, out, _ = call(capsys, "list", "protocols", "./first_protocol.py", "--settings", "--json")
    assert status == 0
    assert json.loads(out)["settings"]["first_protocol"]["loops"] == "2"
    assert list(json.loads(out)["protocols"]) == ["first_protocol"]
    arguments = ["run", "./first_protocol.py", "--rig", "./first_rig.toml", *settings]
    status, out, _ = call(capsys, *arguments, "-o", "p.run.sqlite", "--json")
    assert status == 0
    assert json.loads(out)["runs"][0] | {"samples": 0} == {
        "run": "p.run.sqlite",
        "protocol": "first_protocol",
        "samples": 0,
        "steps": 5,
        "void": 0,
        "timed_out": 0,
        "warnings": [],
        "cause": "done",
        "severity": "none",
    }


@pytest.mark.long("takes three seconds")
@pytest.mark.parametrize(("model", "rig"), [("one_e", "one_wire_twin"), ("two_p", "two_wire_twin")])
def test_the_controller_follows(capsys, made, tmp_path, model, rig):
    words = ["--reference", "ramps", "--set", "seconds=60", "--rig", rig, "-o", "c.run.sqlite", "--quiet"]
    file = model_file(tmp_path, model)
    status, out, _ = call(capsys, "track", file, *words, "--controller", "./first_controller.py", "--json")
    assert status == 0
    assert json.loads(out)["track"]["rms_counts"] < 1.0


def test_the_effect_is_the_identity_at_zero_strength_and_something_beyond(made):
    currents = [0.9, 0.4, 0.8, 0.3]
    kind = catalogue_entry(EFFECTS, resolve_name(EFFECTS, str(made["effect"])))
    nothing = driven(currents, hold_s=20.0)
    assert np.array_equal(driven(currents, kind(0.0), hold_s=20.0), nothing)
    change = [np.abs(driven(currents, kind(s), hold_s=20.0) - nothing).max() for s in (2.5, 5.0)]
    assert 0 < 0.9 * change[1] < 2 * change[0] < 1.1 * change[1]


def test_the_effect_does_not_depend_on_the_length_of_a_tick(made):
    kind = catalogue_entry(EFFECTS, resolve_name(EFFECTS, str(made["effect"])))

    def change(dt_s):
        held = {"hold_s": 20.0, "dt_s": dt_s}
        every = round(0.1 / dt_s)
        return (driven([0.9, 0.4], kind(), **held) - driven([0.9, 0.4], **held))[:, every - 1 :: every]

    fine, coarse = change(0.025), change(0.1)
    assert np.sqrt(np.mean((fine - coarse) ** 2)) < 0.03 * np.sqrt(np.mean(fine**2))


@pytest.mark.skipif(os.name == "nt", reason="a pty")
def test_the_driver_talks(made):
    from device.drivers.supply import Supply

    supply, rig = Supply(), load_rig("bench_one_wire")
    assert rig.links is not None
    where = rig.links.amplifier.model_copy(update={"url": supply.port, "timeout_s": 5.0})
    try:
        source = catalogue_entry(DRIVERS, resolve_name(DRIVERS, str(made["driver"])))(where, rig)
        source.arm()
        assert source.has_lease, "its watchdog was read back"
        source.set_current(0.5)
        assert supply.heard[:5] == ["OUTP OFF", "*IDN?", "CURR 0", "OUTP OFF", "OUTP?"]
        assert supply.heard[-3:] == ["CURR 0.500000", "OUTP ON", "CURR?"]
        assert supply.on
        assert source.measure()[:2] == (0.5, 2.0)
        assert source.off() == ""
        assert not supply.on
        supply.stuck = True
        assert "Its watchdog switches it off within" in source.off(), "by hand only if that fails"
        supply.stuck, supply.takes = False, 1.1
        with pytest.raises(Exception, match=r"set 0\.55 A instead of 0\.5 A"):
            source.set_current(0.5)
        source.close()
    finally:
        supply.close()


def test_the_campaign_can_be_costed_with_an_own_protocol_in_it(capsys, made):
    step = '\n[[step]]\nprotocol = "./first_protocol.py"\npurpose = "test"\nset = { loops = 1 }\n'
    made["campaign"].write_text(made["campaign"].read_text() + step)
    plan = load_campaign(str(made["campaign"]))
    assert [s.label for s in plan.step] == ["initialise", "loop", "validation", "first_protocol"]
    arguments = ["run", made["campaign"], "--rig", "one_wire_twin", "--dry-run", "--json"]
    status, out, _ = call(capsys, *arguments)
    assert status == 0
    assert [p["protocol"] for p in json.loads(out)["preview"]][-1] == "first_protocol"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["protocol", "3x"], "cannot be the name of a protocol"),
        (["protocol", "_x"], "cannot be the name"),
        (["protocol", "for"], "'for' cannot be the name of a protocol: it is a Python keyword"),
        (["effect", "n\nl"], "'n\\nl' cannot be the name"),
        (["protocol", "numpy"], "numpy.py would hide the Python module 'numpy'"),
        (["driver", "queue"], "would hide the Python module 'queue'"),
        (["rig", "CON"], "Windows reserves it for a device"),
        (["effect", "lpt1"], "Windows reserves it for a device"),
        (["protocol", "a/b"], "cannot be the name"),
        (["rig", "größe"], "cannot be the name"),
        (["rig", "one_wire_twin"], "'one_wire_twin' is the name of a shipped rig"),
        (["effect", "walking"], "'walking' is the name of a shipped effect"),
        (["campaign", "characterise"], "is the name of a shipped campaign"),
        (["controller", "inverse"], "'inverse' is the name of a shipped controller"),
        (["protocol", "b", "-o", "c.py"], "must be named b.py"),
        (["rig", "b", "-o", "b.py"], "must be named …toml"),
        (["rig", "there"], "there.toml exists"),
        (["nonsense", "b"], "nonsense"),
    ],
)
def test_a_mistake_is_one_sentence_and_writes_nothing(capsys, tmp_path, monkeypatch, arguments, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.toml").write_text("mine")
    status, _, err = call(capsys, "new", *arguments)
    assert status == 2
    assert says in err
    assert err.strip().count("\n") == 0
    assert [p.name for p in tmp_path.iterdir()] == ["there.toml"]
    assert (tmp_path / "there.toml").read_text() == "mine"


def test_a_table_may_be_called_like_a_module(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert call(capsys, "new", "rig", "numpy")[0] == 0
    assert load_rig("./numpy.toml").name == "numpy"


def test_it_may_go_elsewhere(capsys, tmp_path):
    status, out, _ = call(capsys, "new", "rig", "bench_3", "-o", tmp_path / "rigs" / "third.toml")
    assert status == 0
    assert "smarig check" in out
    assert load_rig(str(tmp_path / "rigs" / "third.toml")).name == "bench_3"
