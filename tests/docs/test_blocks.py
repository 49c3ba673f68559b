"""Every block of every page of docs/ runs as printed, by the rules in ``blocks.py``. One test per page."""

import contextlib
import io
import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from characterised_twin import WORDS, CharacterisedTwin
from docs.blocks import Block, Command, blocks, commands, extras, printed
from extras import lacks
from smarig.cli import run as cli

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = [p for p in sorted(DOCS.rglob("*.md")) if "generated" not in p.parts]
WITH_BLOCKS = [p for p in PAGES if blocks(p)]
LONGEST_S = 300  # for a command that hangs


class Page:
    """What the blocks of one page share: a folder, Python's names, what was printed last.

    ``characterised`` gives the result of its command, which other tests need too.
    """

    def __init__(
        self, name: str, folder: Path, characterised: Callable[[], CharacterisedTwin] | None = None
    ) -> None:
        self.name = name
        self.folder = folder
        self._characterised = characterised
        self.names: dict[str, object] = {"__name__": "__main__"}
        self.output: str | None = None

    def do_all(self, found: list[Block]) -> None:
        """One after the other."""
        for block in found:
            self.do(block)

    def do(self, block: Block) -> None:
        """Run, write or compare it."""
        if block.language == "text":
            self._compare(block)
        elif not block.run:
            self.output = None
        elif block.file:
            self._write(block)
        elif block.language == "python":
            self._python(block)
        elif block.language == "sh":
            self.output = "".join(self._command(command, block) for command in commands(block.text))
        else:
            raise AssertionError(f"{self.name}:{block.line}: a block of '{block.language}' is run by nobody")

    def _write(self, block: Block) -> None:
        path = (self.folder / block.file).resolve()
        assert path.is_relative_to(self.folder.resolve()), f"{self.name}:{block.line}: outside the folder"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(block.content, encoding="utf-8")

    def _python(self, block: Block) -> None:
        code = compile("\n" * block.line + block.text, self.name, "exec")  # its lines are the page's
        with _captured() as output_text:
            exec(code, self.names)
        self.output = output_text.getvalue()

    def _command(self, command: Command, block: Block) -> str:
        if self._characterised is not None and command.words == list(WORDS):
            made = self._characterised()
            made.copied(self.folder)
            status, output = 0, made.printed
        elif command.words:
            with _captured() as output_text:
                status, output = cli(command.words), ""
            output = output_text.getvalue()
        else:
            status, output = _in_shell(command.line, self.folder)
        assert status == command.status, f"{self.name}:{block.line}: {command.line}\n{output}"
        return output

    def _compare(self, block: Block) -> None:
        where = f"{self.name}:{block.line}"
        assert self.output is not None, f"{where}: no output to compare with"
        assert printed(block.text, self.output), f"{where}:\n{block.text}\nis not in\n\n{self.output}"


@contextlib.contextmanager
def _captured():
    output_text = io.StringIO()
    with contextlib.redirect_stdout(output_text), contextlib.redirect_stderr(output_text):
        yield output_text


def _in_shell(line: str, folder: Path) -> tuple[int, str]:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        line,
        shell=True,
        cwd=folder,
        env=os.environ | {"PATH": path},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        timeout=LONGEST_S,
    )
    return done.returncode, done.stdout


LONG = (  # pages whose commands take long; test_printed_commands.py tries them on the parser
    *("self_sensing", "several_loads", "study_files", "hidden_effect", "close_a_loop", "identify_fast"),
    *("laboratory_supply", "export_for_other_programs", "forc_diagrams", "control_findings"),
    *("transformation_temperatures", "figures_for_papers", "first_wire"),
    *("run_overnight", "thermomechanical", "beamline"),
)
TIMED = (
    "labjack",
    "own_bench",
)  # pages whose simulated instruments answer in real time, on a machine that keeps it


@pytest.mark.parametrize(
    "page",
    [pytest.param(p, marks=pytest.mark.long) if p.stem in (*LONG, *TIMED) else p for p in WITH_BLOCKS],
    ids=lambda p: p.relative_to(DOCS).as_posix(),
)
def test_the_blocks_of_a_page(page, tmp_path, monkeypatch, request):
    for extra in filter(lacks, extras(page)):
        pytest.skip(f"the extra '{extra}' is not installed")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))  # as `python` in a notebook of that folder
    monkeypatch.setenv("SMARIG_LOCK_DIR", str(tmp_path / ".locks"))
    monkeypatch.setenv("SMARIG_HISTORY_DIR", str(tmp_path / ".wires"))
    monkeypatch.setenv("COLUMNS", "120")
    name, characterised = (
        page.relative_to(DOCS.parent).as_posix(),
        partial(request.getfixturevalue, "characterised"),
    )
    Page(name, tmp_path, characterised).do_all(blocks(page))


WRONG = {
    "a command that fails": "```sh\nsmarig list nonsense\n```\n",
    "a shell that fails": "```sh\ntrue\nfalse | false\n```\n",
    "a status that is another": "```sh\nsmarig list rigs  # exit status 2\n```\n",
    "Python that raises": "```python\nassert 1 == 2\n```\n",
    "another output": "```python\nprint(1)\n```\n\n```text\n2\n```\n",
    "an output of nothing": "```text\n2\n```\n",
    "an output of what was not run": "<!-- not run: a window -->\n```sh\nls\n```\n\n```text\nx\n```\n",
    "a language that nobody runs": "```c\nint x;\n```\n",
    "no language": "```\nx\n```\n",
    "a table that goes nowhere": "```toml\na = 1\n```\n",
    "a file elsewhere": "```toml\n# file: ../a.toml\na = 1\n```\n",
    "a comment without a reason": "<!-- not run: -->\n```sh\nfalse\n```\n",
}


@pytest.mark.parametrize("text", WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_found(text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "page.md").write_text(f"# Page\n\n{text}", encoding="utf-8")
    with pytest.raises(AssertionError):
        Page("page.md", tmp_path).do_all(blocks(tmp_path / "page.md"))


def test_a_page_that_is_right(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = """# Page

```toml
# file: a.toml
a = 1
```

```python
import pathlib
a = pathlib.Path("a.toml").read_text()
print("first\\nsecond 2.5 mm\\nthird\\nlast")
```

```text
second … mm
…
last
```

```python
assert a == "a = 1\\n"
```

```sh
smarig list rigs              # one line each
smarig list \\
  nonsense                    # exit status 2
cat a.toml | grep a
```

```text
a = 1
```

```{note}
Of no concern.
```

<!-- not run: it opens a window -->
```sh
false
```
"""
    (tmp_path / "page.md").write_text(text, encoding="utf-8")
    here = Page("page.md", tmp_path)
    here.do_all(blocks(tmp_path / "page.md"))
    assert here.output is None
