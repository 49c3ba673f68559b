"""Crafted files for every key of the gate's table: what a hostile author would write there.

``CRAFTED`` holds, by row of the table, files by name. ``ELSEWHERE`` names the tests that craft the files of other rows.
"""

from collections.abc import Iterator

from gate.crafting import (
    Crafted,
    beside,
    campaign_step,
    effect,
    folder,
    journal,
    keyed,
    mat_files,
    model_rig,
    model_with,
    own_rig,
    provenance,
    run_with,
    sql,
    started,
    surface,
    surface_form,
    text_file,
    workbook,
)

_QUEUE = "tests/console/queue/test_allowed.py::"
ELSEWHERE = {
    "HDF5: link, external or virtual storage": (
        "tests/exchange/test_import_hdf5.py::"
        "test_what_is_not_in_the_file_is_refused_with_the_name_of_the_data_set"
    ),
    "queue: experiment": f"{_QUEUE}test_a_queue_that_came_with_the_folder_starts_nothing",
    "queue: rig, load": f"{_QUEUE}test_an_entry_that_was_altered_waits",
    "queue: out": f"{_QUEUE}test_an_entry_that_writes_elsewhere_is_not_allowed",
    "folder of a console: rig file": (
        "tests/console/web/test_led_out.py::test_pages_open_nothing_outside_of_the_folder_that_a_rig_names"
    ),
    "folder of a console: link where the console writes": (
        "tests/console/web/test_written_through_links.py::test_nothing_is_written_through_a_link"
    ),
}
_WAYS = (
    *("absolute", "relative", "through the parent", "a link", "home", "UNC", "a server"),
    *("URL of a file", "URL", "a pipe", "a device"),
)


def _rows() -> Iterator[tuple[str, str, Crafted]]:
    for way in (*_WAYS, "a name of smarig that lies here"):
        yield "run: begun_with.rig", way, started("rig.toml", way, "rig")
        yield "model: rig", way, model_rig(way)
    yield "run: begun_with.rig", "shadow", started("one_wire_twin", "relative", "rig")
    for way in _WAYS:
        profile = started("secret.csv", way, "settings", "file", protocol="step_currents")
        yield "run: settings.file", way, profile
        yield "run: actuator", way, keyed("actuator", "actuator.toml", way)
        yield "model: provenance[].run", way, provenance(way)
    for way in ("absolute", "relative", "through the parent", "a link"):
        yield "run: begun_with.load", way, started("load.csv", way, "load")
        yield "run: rig", way, keyed("rig", "rig.toml", way)
        yield "run: protocol", way, keyed("protocol", "evil.py", way)
    yield (
        "run: begun_with.load",
        "a formula",
        run_with(lambda meta, *_: meta["begun_with"].update(load="20+t")),
    )
    yield "run: protocol", "a campaign", keyed("protocol", "campaign.toml", "absolute")
    for text in ("{evil}=3", "evil.py=3", "evil.x=1", "../evil.py.x=1"):
        started_with = run_with(
            lambda meta, m, c, _, t=text: meta["begun_with"].update(
                effects=[t.format(evil=c.path("evil.py"))]
            )
        )
        yield "run: begun_with.effects", text, started_with
    for key in RIG_KEYS:
        yield key, "named by a run", own_rig(key, "path")
        yield key, "in the text of a run", own_rig(key, "text")
    yield "run: config, rig_values, actuator_values", "values", own_rig("rig: links.DEVICE.driver", "values")
    yield from _words_of_runs()
    for text in ("{evil}", "evil", "evil.py", "../evil", "smarig.plant.effects.creep"):
        yield "model: effects[].name, hysteresis.form", f"effect {text}", effect(text)
    for text in ("evil", "../evil", "os"):
        form = model_with(lambda data, *_, t=text: data["hysteresis"].update(form=t, kind=t))
        yield "model: effects[].name, hysteresis.form", f"form {text}", form
    for shape in ({"variable": "__import__('os')"}, {"formula": "open('victim.csv','w')"}, {"knots": ["t"]}):
        learned = [{"name": "learned", "parameters": {"value_1": 1.0}, "shape": shape}]
        yield (
            "model: effects[].shape",
            str(shape),
            model_with(lambda data, *_, e=learned: data.update(effects=e)),
        )
    yield from _configurations()
    for names in ({"x__run__sqlite": "whole.run.sqlite"}, {"m__model__json": "m.model.json"}, {"x__csv": "data.csv"},
                  {"good__html": "victim.csv"}, {"sub": ""}, {"index__html": "victim.csv"}):  # fmt: skip
        yield "folder of data or runs: symbolic link", str(names), folder(**names)
    cell = "time_s,current_command_A,position_mm\n=cmd|'/C calc'!A0,0,0\n+1,@SUM(1),=1\n"
    yield "CSV: cell", "formulas", text_file("table", lambda m, c: cell)
    yield (
        "XLSX, ODS, Parquet, MAT: link to another file, formula, macro",
        "workbook",
        Crafted("workbook", workbook),
    )


RIG_KEYS = (
    *("rig: base", "rig: actuator", "rig: load.file", "rig: load.formula", "rig: links.DEVICE.driver"),
    *("rig: links.DEVICE.url", "rig: links.DEVICE.settings", "rig: links.DEVICE.url with file="),
    *("rig: simulator.library", "rig: simulator.faults", "rig: simulator.trace"),
)


def _words_of_runs() -> Iterator[tuple[str, str, Crafted]]:
    words = "run: own_files, along, model, imported, companions"
    for key in ("along", "model", "wire", "imported"):
        row = "run: wire" if key == "wire" else words
        for way in ("absolute", "through the parent"):
            yield row, f"{key} {way}", keyed(key, "victim.csv", way)
    imported = run_with(
        lambda meta, m, c, _: meta.update(
            imported={"file": c.path("secret.csv")}, companions={c.path("secret.csv"): "0"}
        )
    )
    yield words, "imported", imported
    file = {"kind": "protocol", "name": "evil", "sha256": "0"}
    yield (
        words,
        "own_files",
        run_with(lambda meta, m, c, _: meta.update(own_files=[file | {"path": c.path("evil.py")}])),
    )
    row = "run: view, trigger, virtual table, computed column"
    yield (
        row,
        "trigger",
        sql("CREATE TRIGGER t AFTER INSERT ON event BEGIN SELECT load_extension('OUTSIDE/evil.so'); END"),
    )
    yield row, "view", sql("DROP TABLE event;CREATE VIEW event AS SELECT 0 AS t_s, 'info' AS level, 'k' AS kind, "
                            "load_extension('OUTSIDE/evil.so') AS text, '{}' AS data")  # fmt: skip
    yield row, "virtual table", sql("CREATE VIRTUAL TABLE v USING fts5(x, content='OUTSIDE/victim.csv')")
    row = "run: -journal, -wal beside it"
    yield row, "a journal that names a file", Crafted("run", journal)
    for ending in ("-journal", "-wal", "-shm"):
        for target in ("victim.csv", "pipe"):
            yield row, f"{ending} {target}", beside(ending, target)


def _configurations() -> Iterator[tuple[str, str, Crafted]]:
    for name in (
        "OUTSIDE/x",
        "../../outside/x",
        "a/../../../outside/x",
        "..\\x",
        "/tmp/x",
        "x\0y",
        "-o",
        ".hidden",
        "CON:x",
    ):
        yield "campaign: step.name", name, campaign_step(name)
    for pattern in ("../outside/*.mat", "OUTSIDE/*.mat", "..\\*.mat", "*", "*/*.mat"):
        yield "mapping: mat.files", pattern, mat_files(pattern)
    for name in ("OUTSIDE/m.model.json", "m.model.json", "../outside/m.model.json"):
        yield "actuator: hysteresis.surface", name, surface(name)
    for form in ("OUTSIDE/evil.py", "evil_plugin", "__import__('os').system('true')"):
        yield "actuator: hysteresis.model.form", form, surface_form(form)
    for key in ("campaign: step.protocol", "campaign: step.set.file"):
        yield key, "named by a run", keyed("protocol", "campaign.toml", "absolute")
        yield key, "as the rig of a run", started("campaign.toml", "absolute", "rig")


CRAFTED: dict[str, dict[str, Crafted]] = {}
for _row, _name, _crafted in _rows():
    CRAFTED.setdefault(_row, {})[_name] = _crafted
