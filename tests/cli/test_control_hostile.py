"""Hostile arguments of ``certify``, ``track`` and ``regulate``: each gives one error message before current
flows."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import smarig
from control.model_files import model_file, model_of
from smarig.app.loop_model import ModelSource
from smarig.app.tracking_loop import tracking as tracking_loop
from smarig.cli import run as cli
from smarig.config import load_rig
from smarig.control.controller_settings import TRACKING_CONTROLLERS, default_numbers
from smarig.core.errors import DataError, UsageError
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.forc_curve import ForcCurve
from smarig.preisach.hysteresis.forc_table import ForcTable
from smarig.preisach.hysteresis.hysteresis_json import dump_hysteresis, load_hysteresis
from smarig.preisach.hysteresis.mirrored import Mirrored

ON = ("--rig", "one_wire_twin", "--quiet")
STEPS = ("--reference", "steps", "--set", "seconds=5", "--set", "every_s=2")
TRACK = ("track", "ONE", *STEPS, *ON, "-o", "x")
REGULATE = ("regulate", "ONE", "--setpoint", "6", *ON, "-o", "x")
NODES = np.linspace(0.0, 174.1, 5)


def table(slope):
    """y = slope u on every branch, mm for kelvin."""
    return FodTable(NODES, np.where(np.tri(5, dtype=bool), slope * NODES[None, :], np.nan), "mm")


def model_with(folder, name, slope):
    """A model file of such a table."""
    return replace(model_of("one_e", hysteresis=table(slope)), name=name).save(folder / f"{name}.model.json")


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Names of models, a rig and references, by the words that stand for them; the folder is the working folder."""
    monkeypatch.chdir(tmp_path)
    found = {
        word: model_with(tmp_path, word.lower(), slope).name
        for word, slope in (("FLAT", 0.0), ("FALLING", -0.05), ("STILL", 1e-6), ("LARGE", 0.05))
    }
    data = json.loads((tmp_path / found["LARGE"]).read_text(encoding="utf-8"))
    data["hysteresis"]["rows"][4][3] = 1e300
    (tmp_path / found["LARGE"]).write_text(json.dumps(data), encoding="utf-8")
    (tmp_path / "cool.toml").write_text(
        'name = "cool"\nbase = "one_wire_twin"\n\n[limits]\ntemperature_max_K = 5.0\n', encoding="utf-8"
    )
    references = {
        "TWICE": "time_s,position_mm,position_mm\n0,3,4\n10,6,7\n",
        "SHORT": "time_s,position_mm\n0,3\n10\n",
        "WORD": "time_s,position_mm\n0,3\n10,x\n",
        "BACK": "time_s,position_mm\n0,3\n5,4\n5,4\n",
        "EMPTY": "time_s,position_mm\n",
    }
    for word, text in references.items():
        (tmp_path / f"{word.lower()}.csv").write_text(text, encoding="utf-8")
    csvs = {word: f"{word.lower()}.csv" for word in references}
    return found | csvs | {"ONE": model_file(tmp_path, "one_e").name, "COOL": "cool.toml"}


def tracking(*words):
    return (*TRACK, *words)


def regulating(*words):
    return (*REGULATE, *words)


def following(reference):
    return ("track", "ONE", "--reference", reference, *ON, "-o", "x")


MISTAKES = [
    (2, tracking("--set", "low=-1e308", "--set", "high=1e308"), "The reference's low is outside ±"),
    (2, tracking("--controller-set", "horizon_s=1e-323"), "'inverse', horizon_s is outside ±"),
    (2, tracking("--controller-set", "walk=1e300"), "'inverse', walk is outside ±"),
    (2, tracking("--controller-set", "slope_walk=1e300"), "'inverse', slope_walk is outside ±"),
    (2, tracking("--set", "seed=" + "9" * 400), "whole number from 0 to 2^53"),
    (2, tracking("--set", "seed=-1"), "whole number from 0 to 2^53"),
    (2, tracking("--set", "seconds=0.001"), "The reference lasts 0.001 s. It must last at least"),
    (2, ("certify", "ONE", "--controller", "constant_gain", "--set", "gain=5e-324"), "gain is outside ±"),
    (2, regulating("--hold-s", "0"), "A hold of 0 s is shorter than a tick of this rig, 0.1 s."),
    (2, regulating("--controller-set", "band=-1"), "'pi': band must not be negative (given: -1)"),
    (2, regulating("--disturbance-K", "175"), "A disturbance of 175 K exceeds this rig's whole range"),
    (2, regulating("--disturbance-K", "-1e11"), "A disturbance of -1e+11 K exceeds this rig's whole"),
    (
        2,
        ("regulate", "FLAT", "--setpoint", "0", *ON, "-o", "x"),
        "model flat does not move within this rig's",
    ),
    (2, ("track", "FLAT", *STEPS, *ON, "-o", "x"), "does not move within this rig's limits"),
    (2, ("regulate", "FALLING", "--setpoint", "-5", *ON, "-o", "x"), "falls as its input rises, by 8.705 mm"),
    (2, ("track", "FALLING", *STEPS, *ON, "-o", "x"), "falls as its input rises"),
    (2, ("track", "STILL", *STEPS, *ON, "-o", "x"), "moves by only 0.000174 mm within this rig's limits"),
    (2, ("track", "ONE", *STEPS, "--rig", "COOL", "-o", "x"), "A loop needs 10 counts of the encoder"),
    (4, ("certify", "LARGE"), "hysteresis key rows is 1e+300; the largest number is 1e+12"),
    (4, ("track", "LARGE", *STEPS, *ON, "-o", "x"), "the largest number is"),
    (4, ("regulate", "LARGE", "--setpoint", "6", *ON, "-o", "x"), "the largest number is"),
    (2, following("TWICE"), "twice.csv has 2 columns 'position_mm'"),
    (2, following("SHORT"), "short.csv is not a reference: line 3 has no position_mm."),
    (
        2,
        following("WORD"),
        "word.csv is not a reference: line 3: position_mm is 'x', which is not a finite number.",
    ),
    (2, following("BACK"), "line 4: time_s must increase, but 5 follows 5."),
    (2, following("EMPTY"), "it has no rows below its header."),
    (2, following(""), "No reference ''. There are: steps, ramps, multisine, or a CSV file"),
]


@pytest.mark.parametrize(("status", "words", "says"), MISTAKES)
def test_nonsense_gets_one_sentence_and_leaves_nothing(capsys, tmp_path, files, status, words, says):
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    got = cli([files.get(word, word) for word in words])
    err = capsys.readouterr().err
    assert got == status, err
    assert says in err
    assert err.strip().count("\n") == 0
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


@pytest.mark.parametrize("value", ["1e12", "1e-100"])
@pytest.mark.parametrize(
    ("controller", "key"),
    [(c, k) for c in ("gain_scheduled", "inverse", "pi") for k in default_numbers(TRACKING_CONTROLLERS, c)],
)
def test_what_is_let_through_can_be_computed_with(capsys, files, controller, key, value):
    words = ("--controller", controller, "--controller-set", f"{key}={value}", "--dry-run")
    status = cli(["track", files["ONE"], *STEPS, "--rig", "one_wire_twin", *words])
    assert status == 0, capsys.readouterr().err


def test_a_disturbance_of_the_whole_range_and_no_dead_band_are_allowed(capsys, files):
    words = ("--disturbance-K", "174", "--controller-set", "band=0", "--dry-run")
    status = cli(["regulate", files["ONE"], "--setpoint", "6", "--rig", "one_wire_twin", *words])
    assert status == 0, capsys.readouterr().err


@pytest.mark.parametrize("value", [1e300, -2e12, float("inf"), 10**13, 10**400])
def test_no_kind_of_hysteresis_holds_numbers_beyond_any_wire(value):
    down = [ForcCurve(a, np.linspace(a, 0.0, 5), a * np.linspace(a, 0.0, 5)) for a in (1.0, 2.0)]
    forc, fod = dump_hysteresis(ForcTable.from_curves(down)), dump_hysteresis(table(0.05))
    turned = dump_hysteresis(Mirrored(table(0.05)))
    load_hysteresis(json.loads(json.dumps([forc, fod, turned]))[0])
    forc["curves"][1]["y"][2] = value
    fod["nodes"][4] = value
    turned["image"]["rows"][2][1] = value
    for data in (forc, fod, turned):
        with pytest.raises(DataError, match=r"hysteresis key (y|nodes|rows) is .*; the largest number is"):
            load_hysteresis(data)


def test_a_notebooks_slips_get_a_sentence(files, tmp_path):
    one, on = files["ONE"], {"rig": "one_wire_twin", "out": tmp_path / "x.run.sqlite"}
    slips = {
        "The model must be a name or a path, not None": partial(smarig.track, None, "steps", **on),
        "two rows of numbers: times in s from 0, and positions; got 3": partial(smarig.track, one, 3, **on),
        "The controller must be a name, not None": partial(smarig.track, one, "steps", controller=None, **on),
        "The controller's parameters must be a mapping": partial(
            smarig.regulate, one, 6.0, numbers=[1], **on
        ),
        "The run must be a name or a path, not None": partial(
            smarig.track, one, "steps", rig="one_wire_twin", out=None
        ),
    }
    for says, slip in slips.items():
        with pytest.raises(UsageError, match=says):
            slip()
    with pytest.raises(UsageError, match="The set-point is outside ±"):
        smarig.regulate(one, 10**400, **on)
    with pytest.raises(UsageError, match="seed must be a whole number"):
        tracking_loop(ModelSource.of(one), load_rig("one_wire_twin"), "steps", {"seed": 10**400})
    with pytest.raises(UsageError, match="The model must be a name"):
        ModelSource.of(3)
    assert not (tmp_path / "x.run.sqlite").exists()
