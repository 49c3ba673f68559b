"""Fixtures for all tests: private locks and wire histories, deterministic Hypothesis tests, data of others."""

import contextlib
import os
import signal
import sys
from functools import lru_cache
from importlib import import_module
from pathlib import Path

import pytest
from hypothesis import settings

import pinned_kernels  # noqa: F401  before anything that imports numpy
from computed_once import VARIABLE as COMPUTED
from first_collection import compiled_by_the_first
from returned_memory import ReturnedMemory

CACHE = type(lru_cache(len))

# A job in the background ignores these signals, and its children would.
with contextlib.suppress(ValueError, AttributeError):
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    signal.signal(signal.SIGQUIT, signal.SIG_DFL)

LONG = bool(os.environ.get("SMARIG_LONG"))
settings.register_profile("ci", derandomize=True, deadline=None, max_examples=60 if LONG else 30)
settings.load_profile("ci")

collect_ignore = [
    "fuzz",
    "import_contracts.py",
]  # campaigns of .ci/fuzz need atheris; contracts, import-linter


def pytest_xdist_auto_num_workers():
    """One more than there are cores: many tests wait for processes and devices."""
    return (os.cpu_count() or 1) + 1


LONGEST = (
    "test_real_diagnosis",
    "test_viewers",
    "test_readme",
    "test_diagnose",
    "test_blocks",
    "test_site",
    "test_recovery_on_the_twin",
    "test_promises",
)


def pytest_collection_modifyitems(items):
    """The longest first: else one worker is still at them when the others have nothing left to do.

    What is marked ``long`` runs with ``SMARIG_LONG=1``, as in ``.ci/long``. Of a matrix that is marked with
    ``one_of_each``, the cases that run without it have each value of each parameter; of cases that are marked with
    ``but_first``, the first runs without it.
    """
    places = _places_in_matrices(items)
    firsts = {(item.parent, item.originalname): item for item in reversed(items) if _is_case(item)}
    for item in items if not LONG else ():
        for mark in item.iter_markers("long"):
            if mark.kwargs.get("one_of_each"):
                takes_long = not _on_diagonal(*places[item])
            elif mark.kwargs.get("but_first"):
                takes_long = firsts[item.parent, item.originalname] is not item
            else:
                takes_long = "cases" not in mark.kwargs or item.callspec.id in mark.kwargs["cases"]
            if takes_long:
                why = mark.args[0] if mark.args else "takes long"
                item.add_marker(pytest.mark.skip(reason=f"{why}: SMARIG_LONG=1"))
                break
    items.sort(key=lambda item: item.path.stem not in LONGEST)


def _is_case(item):
    return hasattr(item, "callspec")


def _places_in_matrices(items):
    """By test: the place of its value in each of its lists of parameters, and the lengths of these lists."""
    values = {}  # of each list of a function, with their places
    places = {}
    for item in items:
        if any(mark.kwargs.get("one_of_each") for mark in item.iter_markers("long")):
            keys = [_key(item, mark.args[0]) for mark in item.iter_markers("parametrize")]
            lists = values.setdefault((item.parent, item.originalname), [{} for _ in keys])
            places[item] = [of_list.setdefault(key, len(of_list)) for of_list, key in zip(lists, keys)], lists
    return {item: (of_item, [len(of_list) for of_list in lists]) for item, (of_item, lists) in places.items()}


def _key(item, names):
    names = names.split(",") if isinstance(names, str) else names
    return tuple(id(item.callspec.params[name.strip()]) for name in names)


def _on_diagonal(places, sizes):
    """Whether a case is one of as many as the longest list has values, in which each value of each list occurs.

    Lists with as many values do not go through them together when they begin again.
    """
    lists = [(place, size, size**n) for n, (place, size) in enumerate(zip(places, sizes), 1)]
    return any(
        all(place == (k + k // later) % size for place, size, later in lists) for k in range(max(sizes))
    )


MEMORY = ReturnedMemory()


@pytest.hookimpl(wrapper=True)
def pytest_collection(session):
    MEMORY.before_collection()
    try:
        with compiled_by_the_first(session.config):
            return (yield)
    finally:
        MEMORY.after_collection()


def pytest_runtest_logfinish():
    MEMORY.after_test()


@pytest.fixture(scope="session", autouse=True)
def _private_locks(tmp_path_factory):
    """Test processes run side by side: each has its own idea of which wires are in use. Nothing is left at home."""
    os.environ["SMARIG_LOCK_DIR"] = str(tmp_path_factory.mktemp("locks"))
    os.environ["SMARIG_HISTORY_DIR"] = str(tmp_path_factory.mktemp("wires"))
    os.environ["SMARIG_STATE_DIR"] = str(tmp_path_factory.mktemp("state"))
    os.environ["SMARIG_RUNNING_DIR"] = str(tmp_path_factory.mktemp("running", numbered=True))


def _shared_folder(tmp_path_factory) -> Path:
    """The folder of the session: that of each worker lies in it."""
    own = tmp_path_factory.getbasetemp()
    return own.parent if "PYTEST_XDIST_WORKER" in os.environ else own


@pytest.fixture(scope="session", autouse=True)
def _shared_by_workers(tmp_path_factory):
    """All workers share compiled loops, also with the processes they start, previews, and what is computed once."""
    shared = _shared_folder(tmp_path_factory)
    computed = shared / "computed"
    computed.mkdir(exist_ok=True)
    os.environ[COMPUTED] = str(computed)
    os.environ["SMARIG_CACHE_DIR"] = str(shared / "compiled")
    if os.environ.pop(
        "PYTHONDONTWRITEBYTECODE", ""
    ):  # else every process that tests start compiles all it imports
        os.environ["PYTHONPYCACHEPREFIX"] = str(shared / "bytecode")
    with pytest.MonkeyPatch.context() as patch:
        module = import_module("smarig.runner.preview")
        patch.setattr(
            module, "_computed", import_module("shared_previews").SharedPreviews(shared / "previews")
        )
        yield


@pytest.fixture(scope="session", autouse=True)
def _pages_without_drawings():
    """A drawing takes a third of the time of a page that most tests read for its words, or not at all.

    Nothing is imported for it: who draws first imports Matplotlib.
    """
    with _drawn_by(lambda panel, label="", width_px=0: "<svg></svg>"):
        yield


@pytest.fixture(scope="module")
def drawings():
    """Figures are drawn in the tests of this module."""
    with _drawn_by(import_module("smarig.report.drawing.drawing").svg_of):
        yield


@contextlib.contextmanager
def _drawn_by(svg_of):
    names = vars(import_module("smarig.report.drawing"))
    before = names.get("svg_of")
    names["svg_of"] = svg_of
    yield
    names.pop("svg_of")
    if before is not None:
        names["svg_of"] = before


@pytest.fixture(scope="session")
def characterised(tmp_path_factory, _shared_by_workers):
    """The one-wire twin, characterised once in the session; imported here, for few tests need it."""
    module = import_module("characterised_twin")
    return module.characterised_twin(_shared_folder(tmp_path_factory) / "characterised")


@pytest.fixture(scope="module", autouse=True)
def _caches_of_a_file(request):
    """What a file's tests have computed, its caches and those of smarig, is of no use to the next file."""
    yield
    modules = [m for name, m in sys.modules.items() if name.startswith("smarig.")]
    for module in (*modules, request.module):
        for value in list(vars(module).values()):
            # a cache without a bound in smarig is small, and dear to fill
            if isinstance(value, CACHE) and (module is request.module or value.cache_parameters()["maxsize"]):
                value.cache_clear()
    MEMORY.after_file()


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Measurements by others in a folder next to the repository; tests that need them are skipped without
    it."""
    folder = Path(__file__).resolve().parents[2] / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(
            f"no folder {folder.parent.name}/{folder.name} with others' measurements beside the repository"
        )
    return folder
