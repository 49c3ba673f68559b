"""A package of ``smarig new plugin`` passes its tests, is listed and used by name, and no run or model imports it."""

import json
import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

import smarig
from cli.plugin_site import BENCH, RIG, RUN, imported, install
from control.model_files import model_file
from runner.interrupted import cut
from smarig.cli import run as cli
from smarig.preisach import surface_form
from smarig.record import load_run
from smarig.study.parallel import completed


def call(capsys, *arguments):
    status = cli([str(a) for a in arguments])
    out, err = capsys.readouterr()
    return status, out, err


@pytest.mark.long("takes ten seconds")
def test_the_tests_of_a_new_package_pass(project, acme):
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests"],
        cwd=project, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert "9 passed" in done.stdout
    assert "my_" not in "".join(f.read_text() for f in project.rglob("*.py")).replace("./my_rig.toml", "")


@pytest.mark.long("takes a second")
def test_lists_show_the_origin_and_import_nothing(capsys, acme):
    status, out, _ = call(capsys, "list", "--settings", "--json")
    found = json.loads(out)
    assert status == 0
    assert found["plugins"]["acme_surface_form"] == "surface form of acme 0.1.0"
    for kind in ("effect", "protocol", "controller"):
        assert found[f"{kind}s"][f"acme_{kind}"] == "plug-in of acme 0.1.0"
    assert imported() == []
    status, out, _ = call(capsys, "list", "effects", "acme_effect", "--settings")
    assert (status, "(acme 0.1.0)" in out, "share_percent = 5 %" in out) == (0, True, True)
    assert "acme.acme_protocol" not in imported(), "only the one that was named"


def test_broken_plugins_are_listed_and_stop_nothing(capsys, acme):
    site = acme / "site"
    sys.path.insert(0, str(site))
    points = {
        "smarig.effects": {
            "creep": "acme:x",
            "acme_effect": "acme:x",
            "lost": "nowhere:lost",
            "late": "late:late",
        },
        "smarig.effect": {"typo": "acme:x"},
    }
    install(site, "bad", "2", points, {"late.py": "raise RuntimeError('not today')\n"})
    try:
        status, out, _ = call(capsys, "list", "--json")
        found = json.loads(out)["plugins"]
        assert status == 0
        assert "'creep' is the name of a shipped effect" in found["creep"]
        assert "also offered by bad 2" in found["acme_effect"]
        assert "its module 'nowhere' is missing" in found["lost"]
        assert "smarig has no group 'smarig.effect'; did you mean smarig.effects?" in found["typo"]
        assert found["late"] == "effect of bad 2"
        status, _, err = call(capsys, "run", "validation", *RIG, "--effect", "late", "-o", "v.run.sqlite")
        assert status == 2
        assert err == "smarig: The effect 'late' of bad 2 cannot be imported: RuntimeError: not today.\n"
        assert call(capsys, "run", "validation", *RIG, "--effect", "creep", "--dry-run")[0] == 0
    finally:
        sys.path.remove(str(site))


def test_a_run_holds_the_plugins_that_it_was_made_with(capsys, acme):
    assert call(capsys, *RUN, "-o", "r.run.sqlite")[0] == 0
    run = load_run("r.run.sqlite")
    assert (run.meta["protocol"], run.meta["effects"]) == (
        "acme_protocol",
        ["acme_effect(share_percent=20, time_constant_s=60)"],
    )
    for entry in run.meta["own_files"]:
        assert (entry["distribution"], entry["version"], len(entry["sha256"])) == ("acme", "0.1.0", 64)
        assert entry["text"] == Path(entry["path"]).read_text()
    assert [entry["kind"] for entry in run.meta["own_files"]] == ["protocol", "effect"]


@pytest.mark.long("takes three seconds")
def test_resuming_needs_the_same_plugins_by_name(capsys, acme, project):
    assert call(capsys, *RUN, "-o", "r.run.sqlite")[0] == 0
    cut(Path("r.run.sqlite"), acme / "k.run.sqlite", int(load_run("r.run.sqlite")["tick"][-1]) - 100)
    status, _, err = call(capsys, "resume", "k.run.sqlite")
    assert status == 2
    assert "the plug-in 'acme_protocol' of acme 0.1.0" in err
    assert err.strip().endswith("smarig resume k.run.sqlite --protocol acme_protocol.")
    named = ("--protocol", "acme_protocol", "--effect", "acme_effect", "--quiet")
    other = shutil.copy("k.run.sqlite", "other.run.sqlite")
    with sqlite3.connect(other) as db:
        (text,) = db.execute("SELECT value FROM run WHERE key = 'own_files'").fetchone()
        text = text.replace('"0.1.0"', '"0.0.9"')
        db.execute("UPDATE run SET value = ? WHERE key = 'own_files'", (text,))
    db.close()
    status, _, err = call(capsys, "resume", other, *named)
    assert status == 2
    assert "protocol 'acme_protocol' of acme 0.0.9, not of acme 0.1.0" in err
    assert call(capsys, "resume", "k.run.sqlite", *named)[0] == 0
    assert load_run("k.run.sqlite").cause == "done"


@pytest.mark.long("takes three seconds")
def test_a_form_and_an_export_format_are_used_by_name(capsys, acme):
    levels = ("--set", "partition_K=0,60,120,174")
    assert (
        call(capsys, "run", "first_order_descending", *RIG, *levels, "-o", "f.run.sqlite", "--quiet")[0] == 0
    )
    form = "acme_surface_form"
    assert call(capsys, "identify", "f.run.sqlite", "--surface", form, "-o", "m.model.json")[0] == 0
    assert json.loads((acme / "m.model.json").read_text())["hysteresis"]["form"] == form
    status, _, err = call(capsys, "verify", "m.model.json", "f.run.sqlite")
    assert status != 0
    assert f"smarig --plugin {form}" in err
    assert call(capsys, "--plugin", form, "verify", "m.model.json", "f.run.sqlite")[0] == 0
    assert call(capsys, "verify", "m.model.json", "f.run.sqlite")[0] != 0, "the next command names nothing"
    assert call(capsys, "export", "f.run.sqlite", "--to", "acme_export_format", "-o", "f.json")[0] == 0
    assert len(json.loads((acme / "f.json").read_text())["columns"]["t_s"]) == len(load_run("f.run.sqlite"))
    status, _, err = call(capsys, "identify", "f.run.sqlite", "--surface", "acme", "-o", "n.model.json")
    assert status == 2
    assert "'acme' is not one of" in err
    with pytest.raises(smarig.core.UsageError, match="plug-in of acme"):
        surface_form(form)


def test_other_processes_use_the_same_plugins(acme):
    smarig.use_plugin("acme_surface_form")
    found = list(completed(surface_form, ["acme_surface_form"] * 2, 2))
    assert [type(form).__module__ for form in found] == ["acme.acme_surface_form"] * 2


def test_a_rig_file_names_the_driver_of_a_plugin(capsys, acme):
    (acme / "bench.toml").write_text(BENCH)
    assert call(capsys, "check", "./bench.toml", "--no-current")[0] == 0
    (acme / "typo.toml").write_text(BENCH.replace("acme_driver", "acme_drive"))
    status, _, err = call(capsys, "check", "./typo.toml", "--no-current")
    assert status == 2
    assert "no driver 'acme_drive'; did you mean acme_driver?" in err


@pytest.mark.long("takes three seconds")
def test_a_driver_of_a_plugin_is_recorded_and_not_loaded_by_the_run(capsys, acme):
    text = "from smarig.device import smarig_amplifier as amp\ndef relay(where, rig):\n    return amp(where, rig)\n"
    site = acme / "site"
    info = install(
        site, "relays", "1", {"smarig.drivers": {"relay": "relaying:relay"}}, {"relaying.py": text}
    )
    sys.path.insert(0, str(site))
    try:
        (acme / "bench.toml").write_text(BENCH.replace("acme_driver", "relay"))
        words = ("run", "validation", "--rig", "./bench.toml", "--set", "points=2", "--quiet")
        assert call(capsys, *words, "-o", "d.run.sqlite")[0] == 0
        (entry,) = load_run("d.run.sqlite").meta["own_files"]
        assert (entry["kind"], entry["name"], entry["distribution"]) == ("driver", "relay", "relays")
        cut(Path("d.run.sqlite"), acme / "k.run.sqlite", 1500)
        assert "which is not read" in call(capsys, "resume", "k.run.sqlite")[2]
        newer = (info / "METADATA").read_text().replace("Version: 1\n", "Version: 2\n")
        (info / "METADATA").write_text(newer)
        status, _, err = call(capsys, "resume", "k.run.sqlite", "--rig", "./bench.toml", "--quiet")
        assert status == 2
        assert "links.amplifier.driver was 'relay (relays 1)', is now 'relay (relays 2)'" in err
        (info / "METADATA").write_text(newer.replace("Version: 2\n", "Version: 1\n"))
        assert call(capsys, "resume", "k.run.sqlite", "--rig", "./bench.toml", "--quiet")[0] == 0
    finally:
        sys.path.remove(str(site))
        sys.modules.pop("relaying", None)


def test_a_plugin_replaces_no_campaign_and_no_shipped_controller(capsys, acme):
    site = acme / "site"
    points = {
        "smarig.protocols": {"quick_look": "thief:x"},
        "smarig.controllers": {"leaky_pi": "thief:x"},
        "smarig.export_formats": {"fmu": "thief:x"},
    }
    install(site, "thief", "1", points, {"thief.py": "raise SystemExit('imported')\n"})
    sys.path.insert(0, str(site))
    try:
        assert call(capsys, "run", "quick_look", *RIG, "--dry-run")[0] == 0
        model = model_file(acme, "one_e")
        ramps = ("--reference", "ramps", "--set", "seconds=10", "--controller", "leaky_pi")
        assert call(capsys, "track", model, *ramps, *RIG, "--dry-run")[0] == 0
        assert call(capsys, "export", model, "--to", "fmu", "-o", "m.fmu")[0] == 0
        assert "thief" not in sys.modules
    finally:
        sys.path.remove(str(site))


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["plugin", "3x"], "cannot be the name of a plugin"),
        (["plugin", "for"], "it is a Python keyword"),
        (["plugin", "a.b"], "cannot be the name of a plugin"),
        (["plugin", "lab-"], "end it with a letter or digit"),
        (["plugin", "numpy"], "The package 'numpy' would hide a Python module"),
        (["plugin", "there"], "there exists"),
        (["plugin", "b", "--kind", "nonsense"], "nonsense"),
        (["effect", "b", "--kind", "effect"], "--kind belongs to smarig new plugin"),
    ],
)
def test_a_mistake_is_one_sentence_and_writes_nothing(capsys, tmp_path, monkeypatch, arguments, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").mkdir()
    status, _, err = call(capsys, "new", *arguments)
    assert status == 2
    assert says in err
    assert err.strip().count("\n") == 0
    assert [p.name for p in tmp_path.rglob("*")] == ["there"]


def test_a_distribution_may_have_hyphens(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, out, _ = call(capsys, "new", "plugin", "lab-wires", "--json")
    assert (status, json.loads(out)["plugins"]) == (0, {"effect": "lab_wires_effect"})
    assert (tmp_path / "lab-wires" / "src" / "lab_wires" / "lab_wires_effect.py").is_file()
    assert 'name = "lab-wires"' in (tmp_path / "lab-wires" / "pyproject.toml").read_text()
