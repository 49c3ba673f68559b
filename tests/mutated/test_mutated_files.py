"""A part of the campaign of mutated files: each is read, or refused in a sentence, and never anything else.

All of it, 10,000 a format in children with limits of time and memory: ``.ci/fuzz``, or ``python -m mutated.campaign``.
"""

import io
from collections import Counter
from functools import cache

import pytest

from extras import skip_without

skip_without("h5py", extra="files")
skip_without("openpyxl", extra="files")
skip_without("pyarrow", extra="parquet")

from mutated.campaign import open_one  # noqa: E402
from mutated.formats import FORMATS  # noqa: E402
from smarig.exchange.binary import hdf5_child, hdf5_process  # noqa: E402

pytestmark = [
    pytest.mark.filterwarnings("ignore"),  # of libraries, on what they read
]
EACH = 50
LONGEST_SENTENCE = 5000


@pytest.fixture(autouse=True)
def _read_here(monkeypatch):
    """HDF5 without a child, which takes longest to start."""

    class Child:
        def __init__(self, path, group):
            self.stdout = io.BytesIO()
            hdf5_child.answer(str(path), group, self.stdout)
            self.stdout.seek(0)

        kill = wait = lambda self: None

    for name in ("_rehearse", "_open_nothing_else"):
        monkeypatch.setattr(hdf5_child, name, lambda: None)
    monkeypatch.setattr(hdf5_process, "started", Child)


@pytest.fixture(scope="module")
def seeds(tmp_path_factory):
    """Honest files of a format."""
    folder = tmp_path_factory.mktemp("honest")

    @cache
    def of_format(name):
        if name == "tdms":
            skip_without("nptdms", extra="tdms")
        return FORMATS[name].seeds(folder)

    return of_format


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "own csv",
        "text",
    ),
)
@pytest.mark.parametrize("name", FORMATS)
def test_every_seed_but_few_is_read(tmp_path, seeds, name):
    """Otherwise every mutation would be refused for another reason than its own."""
    form, path = FORMATS[name], tmp_path / f"honest{FORMATS[name].ending}"
    refused = []
    for content in seeds(name):
        path.write_bytes(content)
        refused += [said] if (said := open_one(form, path)) else []
    assert len(refused) <= len(seeds(name)) // 4, refused


@pytest.mark.long("takes two seconds", cases=("run", "text", "xlsx"))
@pytest.mark.parametrize("name", FORMATS)
def test_a_mutated_file_is_read_or_refused_in_a_sentence(tmp_path, seeds, name):
    form, path, ended = FORMATS[name], tmp_path / f"mutated{FORMATS[name].ending}", Counter()
    for number in range(EACH):
        path.write_bytes(form.mutation(seeds(name), number))
        said = open_one(form, path)
        ended[bool(said)] += 1
        assert len(said) < LONGEST_SENTENCE, number
        assert "\n" not in said.strip() or name in ("rig", "actuator", "campaign", "mapping")
    assert min(ended.values()) >= EACH // 20, "the mutations are too weak, or too strong"
    assert form.mutation(seeds(name), 0) == form.mutation(seeds(name), 0)
