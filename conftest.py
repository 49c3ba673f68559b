"""What this environment lacks is a skip with its name, and ``--skipped`` runs what the last run skipped.

``.ci/run`` runs all tests with what the README installs, and those it skipped once more with all extras. The closing
lines say how much memory each worker needed.
"""

import re
import sys
from pathlib import Path

import pytest

from extras import lacks
from smarig.core import MissingExtra

SKIPPED = "smarig/skipped"  # in pytest's cache, beside the failures of --last-failed
BY_CHOICE = "SMARIG_LONG=1"  # in the reason of a test that takes long: it is skipped whatever is installed


def pytest_addoption(parser):
    parser.addoption("--skipped", action="store_true", help="Run only the tests that the last run skipped.")


def _skipped_for_an_extra(report, call, path: str, line: int) -> None:
    """Only if the extra is not there: a MissingExtra beside an installed package is a failure."""
    error = call.excinfo.value if call.excinfo else None
    if isinstance(error, MissingExtra) and lacks(error.extra):
        report.outcome = "skipped"
        report.longrepr = (path, line, f"Skipped: the extra '{error.extra}' is not installed")


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    report = yield
    if report.failed:
        _skipped_for_an_extra(report, report.call, str(collector.path), 0)
        _forget_what_failed(str(collector.path))
    return report


def _forget_what_failed(path: str) -> None:
    """pytest leaves a module that it could not import half made in sys.modules, where tests would meet it."""
    for name, module in list(sys.modules.items()):
        if getattr(module, "__file__", None) == path:
            del sys.modules[name]


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    report = yield
    if report.failed:
        path, line, _ = item.location
        _skipped_for_an_extra(report, call, path, (line or 0) + 1)
    return report


def pytest_configure(config):
    config.pluginmanager.register(Skipped(config), "skipped tests")


class Skipped:
    """The names of skipped tests and files, kept for the next run."""

    def __init__(self, config) -> None:
        self.config = config
        self.names: set[str] = set()
        self.cache = getattr(config, "cache", None)  # none with -p no:cacheprovider
        self.wanted = set(self.cache.get(SKIPPED, [])) if self.cache and config.option.skipped else set()
        if self.wanted:
            config.args = sorted({name.partition("::")[0] for name in self.wanted})

    def pytest_collection_modifyitems(self, items):
        if self.config.option.skipped:
            items[:] = [i for i in items if {i.nodeid, i.nodeid.partition("::")[0]} & self.wanted]

    def pytest_runtest_logreport(self, report):
        if report.skipped and not hasattr(report, "wasxfail") and BY_CHOICE not in str(report.longrepr):
            self.names.add(report.nodeid)

    def pytest_collectreport(self, report):
        if report.skipped:
            self.names.add(report.nodeid)

    def pytest_sessionfinish(self):
        whole = not (
            hasattr(self.config, "workerinput") or self.config.option.collectonly
        )  # a worker saw a part
        if whole and self.cache:
            self.cache.set(SKIPPED, sorted(self.names))


STATUS = Path("/proc/self/status")
PEAKS_MB = pytest.StashKey[list[int]]()  # of the workers that have ended


def pytest_sessionfinish(session):
    """A worker tells how much memory it needed at the most, where the system counts it."""
    output = getattr(session.config, "workeroutput", None)
    if output is not None and STATUS.exists():
        peak = re.search(r"VmHWM:\s+(\d+) kB", STATUS.read_text())
        output["peak_MB"] = int(peak[1]) * 1024 // 10**6 if peak else 0


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    """Hears it from a worker that has ended; one that died tells nothing."""
    if peak_MB := getattr(node, "workeroutput", {}).get("peak_MB"):
        node.config.stash.setdefault(PEAKS_MB, []).append(peak_MB)


def pytest_terminal_summary(terminalreporter, config):
    """One line, before pytest's own."""
    if peaks_MB := config.stash.get(PEAKS_MB, []):
        terminalreporter.write_line(f"peak memory of the workers: {', '.join(map(str, peaks_MB))} MB")
