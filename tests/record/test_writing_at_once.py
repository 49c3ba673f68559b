"""Imports and simulations write a whole run or nothing."""

import numpy as np
import pytest

from record.runs import META, beside
from smarig.core.errors import StorageError, UsageError
from smarig.record import load_run
from smarig.record.new_run_file import write_run

COLUMNS = {"tick": np.arange(4), "input": [0.0, 1.0, np.nan, 3.0], "position": np.linspace(0, 1, 4)}
STEPS = [(0, 0, 0, "rise", 43.5, 0.0, 9.9, "settled", 1.5, 250)]


def test_columns_steps_and_absent_channels(tmp_path):
    path = tmp_path / "a.run.sqlite"
    write_run(path, META, COLUMNS, STEPS, force=False)
    run = load_run(path)
    np.testing.assert_array_equal(run["input"], COLUMNS["input"])
    np.testing.assert_array_equal(run["position"], COLUMNS["position"])
    assert run["quality"].tolist() == [0, 0, 0, 0]
    assert not run.has("current_A")
    assert run.points()[0].tolist() == [43.5]
    assert (run.complete, run.meta["rig"]) == (True, "bench")
    assert beside(path) == ["a.run.sqlite"]


BROKEN = {
    "ragged columns": ({**COLUMNS, "position": [1.0]}, STEPS, ValueError),
    "no ticks": ({"input": [1.0]}, STEPS, KeyError),
    "a tick twice": ({"tick": [0, 0]}, STEPS, StorageError),
    "short step": (COLUMNS, [(0, 0, 0)], StorageError),
    "an unknown type": (COLUMNS, [(object(), *STEPS[0][1:])], StorageError),
}


def failing_half_way():
    """Three good values, then the source of the data breaks."""
    yield from (0.0, 1.0, 2.0)
    raise SourceGoneError


class SourceGoneError(Exception):
    """Stands for whatever goes wrong in an importer."""


@pytest.mark.parametrize("existing", [False, True])
@pytest.mark.parametrize("kind", [*BROKEN, "an iterator that breaks"])
def test_a_failed_write_leaves_everything_as_it_was(tmp_path, kind: str, existing: bool):
    path = tmp_path / "a.run.sqlite"
    if existing:
        write_run(path, META, COLUMNS, STEPS, force=False)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    columns, steps, error = BROKEN.get(
        kind, ({**COLUMNS, "position": failing_half_way()}, STEPS, SourceGoneError)
    )
    with pytest.raises(error):
        write_run(path, META, columns, steps, force=existing)
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


def test_an_existing_run_is_kept_unless_forced(tmp_path):
    path = tmp_path / "a.run.sqlite"
    write_run(path, META, COLUMNS, STEPS, force=False)
    with pytest.raises(UsageError, match=r"a\.run\.sqlite exists. Give another name, or --force"):
        write_run(path, META, {"tick": [1]}, [], force=False)
    assert len(load_run(path)) == 4
    write_run(path, META, {"tick": [1]}, [], force=True)
    assert len(load_run(path)) == 1


def test_a_place_that_cannot_be_is_one_sentence(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(StorageError, match=r"a\.run\.sqlite\S* cannot be created: "):
        write_run(tmp_path / "file" / "a.run.sqlite", META, COLUMNS, STEPS, force=False)
    with pytest.raises(StorageError, match="cannot be created: "):
        write_run(tmp_path, META, COLUMNS, STEPS, force=True)
