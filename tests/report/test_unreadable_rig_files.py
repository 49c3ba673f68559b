"""A recorded rig file or actuator that is no TOML: the run has a page, and is compared, all the same."""

import pytest

from record.runs import META, sample
from smarig.cli import run
from smarig.record import Recorder

UNREADABLE = {
    "no TOML": "name = ",
    "an integer": "name = " + "9" * 5000,
    "nested lists": "name = " + "[" * 10_000 + "]" * 10_000,
    "a key of many parts": "a" + ".a" * 20_000 + " = 1",
}


@pytest.mark.parametrize("kind", UNREADABLE)
def test_it_has_a_page_and_is_compared(kind, tmp_path, capsys):
    pages = []
    for name in ("a", "b"):
        recorder = Recorder(
            tmp_path / f"{name}.run.sqlite",
            {**META, "config": UNREADABLE[kind], "actuator_text": UNREADABLE[kind]},
        )
        for tick in range(20):
            recorder.sample(sample(tick), 0, float(tick))
        recorder.close()
        pages.append(str(recorder.path))
    for runs in (pages[:1], pages):
        status = run(["report", *runs, "-o", str(tmp_path / f"{len(runs)}.html")])
        assert status in (0, 4), capsys.readouterr().err
