"""--force replaces a file only by another of the same kind, recognised by its content and not only by its name."""

import pytest

from control.model_files import model_file
from record.runs import META
from smarig.cli import run as cli
from smarig.core.atomic_file import atomic_file, check_writable
from smarig.core.errors import UsageError
from smarig.core.file_content import JSON, MODEL, PAGE, RUN, TABLE, TOML, content_kind
from smarig.diagnosis.diagnosis_files import DIAGNOSIS_FILES, prepare_folder
from smarig.exchange import export_run
from smarig.record.new_run_file import write_run
from smarig.record.recorder import Recorder
from smarig.report.components.page import page, write_page

COLUMNS = {"tick": [0, 1, 2], "t_s": [0.0, 0.1, 0.2], "position": [0.0, 1.0, 2.0]}
STEPS = ("--reference", "steps", "--set", "seconds=5", "--set", "every_s=5")
ON = ("--rig", "one_wire_twin", "--quiet")


def made(folder, kind, name):
    """A file of a kind under any name, written as smarig writes it."""
    path = folder / name
    if kind == RUN:
        write_run(path, META, COLUMNS, [], force=True)
    elif kind == MODEL:
        model_file(folder, "one_e").rename(path)
    elif kind == PAGE:
        write_page(page("A title", "A lead.", []), path)
    elif kind == TABLE:
        made(folder, RUN, "source.run.sqlite")
        export_run(folder / "source.run.sqlite", to="csv", out=path)
    elif kind == TOML:
        path.write_text('# why\nname = "separating"\n\n[[step]]\nprotocol = "wiping_out"\n', encoding="utf-8")
    else:
        path.write_text('{\n  "verdict": 1\n}\n', encoding="utf-8")
    return path


KINDS = (RUN, MODEL, PAGE, TABLE, TOML, JSON)


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_is_known_whatever_the_name(tmp_path, kind):
    assert content_kind(made(tmp_path, kind, "a.html")) == kind
    assert content_kind(made(tmp_path, kind, "b.run.sqlite")) == kind


def test_an_unrecognised_file_is_classified_by_its_name(tmp_path):
    notes = tmp_path / "notes"
    notes.write_text("buy wire", encoding="utf-8")
    assert content_kind(notes) == "something else"
    assert content_kind(notes, "notes.csv") == TABLE
    notes.write_text("", encoding="utf-8")
    assert content_kind(notes, "notes.csv") == ""


@pytest.mark.parametrize("to", ["parquet", "mat", "netcdf", "rrd"])
def test_other_programs_files_are_known_by_their_first_bytes(tmp_path, to):
    pytest.importorskip({"parquet": "pyarrow", "mat": "scipy", "netcdf": "h5netcdf", "rrd": "rerun"}[to])
    run = made(tmp_path, RUN, "r.run.sqlite")
    out = tmp_path / "no_name"
    export_run(run, to=to, out=out)
    before = out.read_bytes()
    with pytest.raises(UsageError, match="no_name holds a .*, which --force does not replace by a table"):
        export_run(run, to="csv", out=out, force=True)
    assert out.read_bytes() == before
    export_run(run, to=to, out=out, force=True)


@pytest.mark.parametrize("there", KINDS)
@pytest.mark.parametrize("new", [RUN, MODEL, PAGE, TABLE])
def test_a_file_becomes_its_own_kind_only(tmp_path, there, new):
    fresh, old = made(tmp_path, new, "fresh"), made(tmp_path, there, "old")
    before = old.read_bytes()

    def write():
        with atomic_file(old, force=True) as part:
            part.write_bytes(fresh.read_bytes())

    if there == new:
        write()
        return
    with pytest.raises(UsageError, match=f"old holds {there}, which --force does not replace by {new}"):
        write()
    with pytest.raises(UsageError, match=f"does not replace by {new}"):
        check_writable(old, force=True, kind=new)
    assert old.read_bytes() == before
    assert not list(tmp_path.glob("*.part"))


@pytest.mark.parametrize("there", [MODEL, PAGE, TABLE])
def test_no_recorder_begins_on_what_is_no_run(tmp_path, there):
    old = made(tmp_path, there, "x.run.sqlite")
    before = old.read_bytes()
    for write in (
        lambda: write_run(old, META, COLUMNS, [], force=True),
        lambda: Recorder(old, META, force=True).close("done"),
    ):
        with pytest.raises(UsageError, match=f"holds {there}, which --force does not replace by a run"):
            write()
    assert old.read_bytes() == before


COMMANDS = [
    (RUN, ["certify", "MODEL", "-o", "OLD"]),
    (MODEL, ["certify", "MODEL", "-o", "OLD"]),
    (RUN, ["report", "RUN", "-o", "OLD"]),
    (TABLE, ["track", "MODEL", *STEPS, *ON, "-o", "OLD"]),
    (MODEL, ["regulate", "MODEL", "--setpoint", 6, *ON, "-o", "OLD"]),
    (TABLE, ["run", "validation", *ON, "-o", "OLD"]),
    (PAGE, ["simulate", "MODEL", "--protocol", "wiping_out", "-o", "OLD"]),
    (PAGE, ["export", "RUN", "--to", "csv", "-o", "OLD"]),
    (RUN, ["identify", "RUN", "-o", "OLD"]),
    (TABLE, ["diagnose", "MODEL", "--train", "RUN", "--propose", "OLD"]),
]


@pytest.mark.parametrize(("there", "words"), COMMANDS)
def test_force_destroys_nothing_of_another_kind(capsys, tmp_path, there, words):
    files = {
        "RUN": made(tmp_path, RUN, "r"),
        "OLD": made(tmp_path, there, "old"),
        "MODEL": model_file(tmp_path, "one_e"),
    }
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    status = cli([str(files.get(word, word)) for word in (*words, "--force")])
    err = capsys.readouterr().err
    assert status == 2, err
    assert f"old holds {there}, which --force does not replace by" in err
    assert err.strip().count("\n") == 0
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


@pytest.mark.parametrize("name", DIAGNOSIS_FILES)
def test_a_diagnosis_looks_at_its_folder_before_it_computes(tmp_path, name):
    made(tmp_path, TABLE, name)
    with pytest.raises(
        UsageError, match=f"{name} holds a table of numbers, which --force does not replace by"
    ):
        prepare_folder(tmp_path, force=True)


def test_a_link_to_itself_as_an_output_is_no_internal_error(tmp_path):
    out = tmp_path / "a.run.sqlite"
    out.symlink_to(out)
    assert cli(["run", "validation", *ON, "--set", "points=2", "-o", str(out), "--force"]) in (0, 2)
