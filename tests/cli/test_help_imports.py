"""Help answers at once: it imports nothing that computes, draws or reads configurations."""

import json
import subprocess
import sys

from smarig.core import catalogue_names

COMMANDS = [n.rstrip("_") for n in catalogue_names("smarig.cli.commands")]
HEAVY = (
    *("numpy", "scipy", "matplotlib", "plotly", "pandas", "pydantic", "numba", "pyarrow", "h5py"),
    *("rich", "sqlite3", "rerun", "smarig.config.file_schemas", "smarig.runner.runner"),
)
MOST = 260  # modules of one process; numpy alone has about 130
PROGRAM = """
import contextlib, io, json, sys
from smarig.cli import run
found = {}
for command in json.loads(sys.argv[1]):
    with contextlib.redirect_stdout(io.StringIO()) as shown:
        status = run([*command, "--help"])
    heavy = [name for name in json.loads(sys.argv[2]) if name in sys.modules]
    found[" ".join(command)] = [status, shown.getvalue().startswith("Usage: smarig"), heavy]
print(json.dumps([found, len(sys.modules)]))
"""


def test_no_help_imports_what_only_the_work_needs():
    """All in one process, so a command is named from the first on that imports such a module."""
    asked = [*([name] for name in COMMANDS), []]
    arguments = [json.dumps(asked), json.dumps(HEAVY)]
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *arguments], capture_output=True, text=True, check=True, timeout=120
    )
    found, modules = json.loads(done.stdout)
    assert found == {" ".join(command): [0, True, []] for command in asked}
    assert modules <= MOST
