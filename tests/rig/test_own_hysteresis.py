"""An actuator file with the hysteresis of an identified model: its twin is that wire; a bench is compared with it."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.config import load_rig
from smarig.core import ConfigError, LimitExceeded, Quality
from smarig.identification import Calibration
from smarig.plant import Actuator
from smarig.preisach import FodTable, thesis_surface
from smarig.rig import Guard, Plausibility, Twin, TwinSettings

RIG = load_rig("one_wire_twin")
THESIS = Actuator.named("gorbet_one_wire")
NODES = [0.0, 40.0, 70.0, 90.0, 120.0, 174.1]
ROWS = [
    [0.2],
    [0.2, 0.4],
    [0.2, 0.7, 1.4],
    [0.2, 1.0, 2.0, 2.3],
    [0.2, 1.3, 2.5, 2.8, 2.9],
    [0.2, 1.6, 2.8, 3.0, 3.1, 3.1],
]  # outputs in mm: row k begins its descent at node k


def table(unit="mm"):
    values = np.full((len(ROWS), len(ROWS)), np.nan)
    for k, row in enumerate(ROWS):
        values[k, : k + 1] = row
    return FodTable(np.array(NODES), values, unit)


OWN = {"a table": table(), "a surface": replace(thesis_surface("one_e"), y_upper=3.0)}


def written(folder, hysteresis, base=THESIS):
    return Calibration({}, {}).write_actuator(folder / "own.toml", base, hysteresis=hysteresis, force=True)


@pytest.mark.parametrize("hysteresis", OWN.values(), ids=OWN)
def test_what_was_written_is_read_to_the_last_bit(tmp_path, hysteresis):
    found = Actuator.named(str(written(tmp_path, hysteresis))).hysteresis
    u = np.linspace(0.0, 174.1, 40)
    assert np.array_equal(found.swept(u[:, None], u), hysteresis.swept(u[:, None], u))
    assert found.y_lower == hysteresis.y_lower


@pytest.mark.parametrize(("high", "low"), [(5, 2), (4, 1), (3, 3)])
def test_the_twin_takes_the_positions_that_the_table_states(tmp_path, high, low):
    """Heated to a node from the cold, cooled to another: in the steady state, the number of that row and column."""
    wire = Actuator.named(str(written(tmp_path, table())))
    twin = Twin(RIG, wire, TwinSettings(noise=False))
    for node in (high, low):
        for _ in range(1500):
            (sample,) = twin.step(wire.current_for(NODES[node]))
    assert sample.position == pytest.approx(ROWS[high][low] - ROWS[0][0], abs=2 * twin.position_per_count)


def guarded(wire, believed):
    """A guard that takes the twin of one actuator for another."""
    return Guard(Twin(RIG, wire, TwinSettings(seed=3)), RIG.limits, believed, Plausibility(RIG, believed))


def complaints(guard):
    """What a slow loop through the whole range is told: marks of samples, alarms, and what ends it."""
    told = []
    for k in range(2400):
        try:
            answer = guard.step(min(k, 2400 - k) / 1200)
        except LimitExceeded as error:
            return [*told, str(error)]
        told += [sample.t_s for sample, _ in answer if sample.quality & Quality.SUSPECT]
        told += [alarm.text for alarm in guard.alarms()]
    return told


def test_a_sound_wire_unlike_the_thesiss_is_believed_with_its_own_hysteresis_only(tmp_path):
    wire = Actuator.named(str(written(tmp_path, OWN["a surface"])))
    assert "away from all that a wire within limits.model_tolerance" in str(
        complaints(guarded(wire, THESIS))[-1]
    )
    assert complaints(guarded(wire, wire)) == []


def test_two_wires_have_their_own_as_well(tmp_path):
    base = Actuator.named("gorbet_two_wire")
    own = replace(thesis_surface("two_p"), y_upper=30.0)
    wire = Actuator.named(str(written(tmp_path, own, base)))
    assert wire.stroke == pytest.approx(30.0 - own.y_lower)
    Plausibility(load_rig("two_wire_twin"), wire)


@pytest.mark.parametrize(
    ("hysteresis", "says"),
    [
        (table("deg"), "is in deg, but the position of this wire in mm"),
        (replace(OWN["a surface"], y_upper=-3.0), "its output falls when the wire is heated"),
    ],
)
def test_that_of_another_rig_is_not_written(tmp_path, hysteresis, says):
    with pytest.raises(ConfigError, match=says):
        written(tmp_path, hysteresis)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("[hysteresis.model]", 'surface = "one_e"\n\n[hysteresis.model]', "exactly one of surface and model"),
        ('kind = "fod_table"', 'kind = "magic"', "unknown kind of hysteresis 'magic'"),
        ("nodes = [", "nodes = [1e300, ", "hysteresis key nodes is 1e+300"),
        ("rows = [[0.2], ", "rows = [", "requires rows of 1 to 6 values"),
        ('unit = "mm"\n', 'unit = "deg"\n', "but the position of this wire"),
    ],
)
def test_a_wrong_file_is_one_sentence_before_anything_is_opened(tmp_path, capsys, old, new, says):
    path = written(tmp_path, table())
    head, model = path.read_text().split("[hysteresis.model]")
    text = f"{head}[hysteresis.model]{model}"
    assert old in f"[hysteresis.model]{model}"
    path.write_text(head + f"[hysteresis.model]{model}".replace(old, new) if old in text else text)
    rig = tmp_path / "rig.toml"
    rig.write_text('name = "r"\nbase = "one_wire_twin"\nactuator = "./own.toml"\n')
    out = tmp_path / "a.run.sqlite"
    assert cli(["run", "minor_loops", "--rig", str(rig), "-o", str(out), "--quiet"]) == 2
    assert says in capsys.readouterr().err
    assert not out.exists()


def test_neither_surface_nor_model_is_a_mistake(tmp_path, capsys):
    path = written(tmp_path, table())
    path.write_text(path.read_text().split("[hysteresis.model]")[0])
    assert cli(["calibrate", str(tmp_path / "none.run.sqlite"), "--actuator", str(path)]) == 2
    assert "exactly one of surface and model is needed" in capsys.readouterr().err
