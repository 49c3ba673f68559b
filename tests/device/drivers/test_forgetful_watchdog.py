"""The methods of own_bench.md for a watchdog that does not latch meet the contract, with a box whose does not."""

import re
import textwrap
import time
from pathlib import Path

import pytest

from simulators.text_instrument import SimulatedBox
from smarig.cli import run as cli
from smarig.config import LinkFile, load_rig
from smarig.core.catalogue import own_files
from smarig.device import ContractCase, PolledSource, check_contract
from smarig.rig.open_rig import instrument_of

PAGE = Path(__file__).resolve().parents[3] / "docs" / "how_to" / "own_bench.md"
SPEED = 10.0  # a busy machine must not be silent for longer than the lease of 4 s
RIG = load_rig("bench_one_wire").model_copy(update={"lease_s": 4.0})


class Forgets(SimulatedBox):
    """Its output is always on; its watchdog sets the current to zero, and it obeys the next order."""

    def _answer(self, line):
        if self.protected:
            self.level_A, self.protected = 0.0, 0
        self.output = True
        return super()._answer(line)


@pytest.fixture
def opened(tmp_path, monkeypatch):
    """How a driver opens a new box: the example, or with the methods of the page."""
    monkeypatch.chdir(tmp_path)
    boxes = []

    def made(*, by_the_page):
        boxes.append(Forgets(SPEED, lambda _: None, lambda: 5.0, lambda: 2.0))
        name = "latching" if by_the_page else "example"
        assert cli(["new", "driver", name]) == 0
        file = tmp_path / f"{name}.py"
        text = re.sub(r' *self.line.write\("OUTP OFF"\)\n', "", file.read_text())
        text = text.replace(
            'self.line.number("OUTP?") == 0:\n                    return',
            'self.line.number("CURR?") == 0:\n                    return',
        )
        if by_the_page:
            text = with_methods_of_the_page(text)
        file.write_text(text)
        link = LinkFile(driver=str(file), framing="lines", url=boxes[-1].url)
        absent = link.model_copy(update={"url": "tcp://127.0.0.1:1"})
        return ContractCase(
            lambda: PolledSource(instrument_of(link, RIG)),
            lambda: instrument_of(absent, RIG),
            RIG,
            lambda seconds: time.sleep(seconds / SPEED),
        )

    with own_files():
        yield made
    for box in boxes:
        box.close()


def with_methods_of_the_page(text):
    """The example, changed as the page says."""
    (block,) = [
        b for b in re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL) if "_notice_trip" in b
    ]
    first, last = text.index("    def set_current"), text.index("    def off(")
    methods = textwrap.indent(textwrap.dedent(block), "    ")
    text = f"{text[:first]}{methods}\n{text[last:]}"
    return text.replace("        self._on = False\n", "        self._on, self._ordered_A = False, 0.0\n")


def test_the_methods_of_the_page_meet_the_contract(opened):
    found = list(check_contract("amplifier", opened(by_the_page=True)))
    assert [(r.name, r.observed) for r in found if not r.passed] == []
    assert {r.name: r.observed for r in found}["lease"].endswith("because the host was silent.")


def test_those_of_the_example_do_not(opened):
    found = {r.name: r.passed for r in check_contract("amplifier", opened(by_the_page=False))}
    assert not found["lease"]
