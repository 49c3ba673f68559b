"""A box on a text line: an output that sticks while its set-point and its state obey; its lease."""

import pytest

import smarig
from simulators.text_bench import TextBench
from simulators.text_instrument import SimulatedBox
from smarig.cli import run as cli
from smarig.config import load_rig
from smarig.core import ConfigError, Elapsed, Hold, Interrupted, LimitExceeded, RigFault, Severity
from smarig.core.catalogue import own_files
from smarig.record import check_run
from smarig.report.runs.run_assessment import run_assessment
from smarig.rig import TwinSettings
from smarig.rig.shutdown import OFF_ATTEMPTS
from smarig.runner.listener import CallbackListener
from smarig.runner.session import Session

SPEED = 20.0
FLOWS_A = 0.3
SAYS = "0.3 A is still measured: switch it off by hand now."
RIG = """
name = "sticks"
base = "bench_one_wire"
wire = "sticks"
period_s = 0.5
lease_s = 60.0
[links.amplifier]
driver = "./sticking.py"
framing = "lines"
url = ""
[links.encoder_daq]
driver = "./sticking.py"
framing = "lines"
url = ""
[encoder]
resolution = 0.002
[simulator]
devices = "text"
speed = 20.0
"""


class Sticks(SimulatedBox):
    """What flows when ``stuck`` becomes true flows on, whatever is ordered and confirmed. ``mute`` loses answers."""

    stuck = mute = False
    zeros = 0  # orders of zero that arrived
    admits = False  # says itself that its output is on
    _flowed_A = 0.0

    def _answer(self, line: str) -> str | None:
        self.zeros += line == "CURR 0"
        found = "1" if self.stuck and self.admits and line == "OUTP?" else super()._answer(line)
        return None if self.mute else found

    @property
    def flows_A(self) -> float:
        if not self.stuck:
            self._flowed_A = super().flows_A
        return self._flowed_A


@pytest.fixture
def bench(tmp_path, monkeypatch, capsys):
    """The box on its wire, and the rig file that reaches it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    assert cli(["new", "driver", "sticking"]) == 0
    rig = tmp_path / "sticks.toml"
    rig.write_text(RIG)
    monkeypatch.setattr("simulators.text_bench.SimulatedBox", Sticks)
    bench = TextBench(load_rig(str(rig)), TwinSettings(), SPEED)
    rig.write_text(RIG.replace('url = ""', f'url = "{bench.urls["amplifier"]}"') + "start = false\n")
    with own_files():
        yield bench.box, rig
    bench.close()


def held(_setup):
    yield Hold(FLOWS_A, Elapsed(5.0))


def sticking_run(bench, out, error):
    """A session in which the output sticks with the sixth sample, which this error then ends."""
    box, rig = bench
    samples = []

    def watch(sample, _step, _input_K):
        samples.append(sample)
        if len(samples) == 6:
            box.stuck = True
            if error is not None:
                raise error

    with Session(str(rig)) as session:
        session.run("held", {}, out, listeners=[CallbackListener(on_sample=watch)], protocol_factory=held)


@pytest.mark.parametrize(
    ("error", "says", "cause"),
    [
        (None, f"{SAYS} The recorded data are complete.", "done"),
        (
            Interrupted("interrupted by the keyboard (Ctrl-C)"),
            f"Run interrupted by the keyboard (Ctrl-C). Its file is closed. {SAYS}",
            "interrupted by the keyboard (Ctrl-C)",
        ),
        (LimitExceeded("Too hot.").at_zero(), f"Too hot. {SAYS}", f"stopped: Too hot. {SAYS}"),
    ],
    ids=["done", "Ctrl-C", "trip"],
)
def test_a_current_that_flows_on_is_said_and_recorded(bench, tmp_path, error, says, cause):
    out = tmp_path / "r.run.sqlite"
    with pytest.raises(RigFault) as raised:
        sticking_run(bench, out, error)
    run = smarig.load_run(out)
    assert str(raised.value) == says
    assert raised.value.exit_status == 3
    assert run.cause == cause
    (event,) = [e for e in run.events if e.kind == "still_on"]
    assert event.text == SAYS
    assert event.severity == Severity.INVALID
    assert not any("at zero" in sentence for sentence in check_run(out).sentences())
    assert "why the source did not switch off" in run_assessment(run).advice


@pytest.mark.parametrize(
    ("error", "cause"),
    [
        (LimitExceeded("Too hot.").at_zero(), "stopped: Too hot. "),
        (KeyboardInterrupt(), "interrupted at once"),
    ],
    ids=["trip", "second Ctrl-C"],
)
def test_an_output_that_is_not_confirmed_off_is_said_and_recorded(bench, tmp_path, error, cause):
    out = tmp_path / "r.run.sqlite"
    bench[0].admits = True
    with pytest.raises(RigFault, match="did not confirm that it is off"):
        sticking_run(bench, out, error)
    run = smarig.load_run(out)
    assert run.cause.startswith(cause)
    assert "at zero" not in run.cause
    (event,) = [e for e in run.events if e.kind == "still_on"]
    assert "did not confirm that it is off" in event.text
    assert not any("at zero" in sentence for sentence in check_run(out).sentences())


def run_that_loses_its_replies(bench, out, on_still_on):
    """Of a box without a lease, from the sixth sample on. ``on_still_on`` gets the text of each such event."""
    box, rig = bench
    rig.write_text(rig.read_text().replace('framing = "lines"', 'framing = "lines"\ntimeout_s = 0.15'))
    driver = rig.with_name("sticking.py")
    driver.write_text(driver.read_text().replace('self.line.number("SYST:WDOG?")', "-1.0"))

    class Listens(CallbackListener):
        def event(self, t_s, kind, text, *, level="info", **data):
            if kind == "still_on":
                on_still_on(text)

    def loses_replies(sample, _step, _input_K):
        box.mute = sample.tick >= 6
        box.zeros = 0

    with Session(str(rig)) as session:
        session.run("held", {}, out, listeners=[Listens(on_sample=loses_replies)], protocol_factory=held)


def test_without_a_lease_it_is_said_after_the_first_zero_and_once(bench, tmp_path):
    """The others follow: each waits for replies that do not come."""
    box, said, out = bench[0], [], tmp_path / "r.run.sqlite"
    with pytest.raises(RigFault, match="It has no lease: switch it off by hand now"):
        run_that_loses_its_replies(bench, out, lambda text: said.append((box.zeros, text)))
    ((zeros, text),) = said
    assert zeros == 2, "those of one off()"
    assert "It has no lease: switch it off by hand now." in text
    assert box.zeros >= 2 * (1 + OFF_ATTEMPTS)
    assert [e.text for e in smarig.load_run(out).events if e.kind == "still_on"] == [text]


def test_a_source_that_confirms_later_is_said_to_be_off(bench, tmp_path):
    out = tmp_path / "r.run.sqlite"
    with pytest.raises(
        RigFault, match="does not answer [^ ]*\\. Check its power[^.]*\\. The current is at zero\\.$"
    ):
        run_that_loses_its_replies(bench, out, lambda _: setattr(bench[0], "mute", False))
    kinds = [e.kind for e in smarig.load_run(out).events]
    assert kinds[kinds.index("still_on") :][:2] == ["still_on", "off"]


def test_a_current_that_ends_is_at_zero(bench, tmp_path):
    box, rig = bench
    with Session(str(rig)) as session:
        session.run("held", {}, tmp_path / "r.run.sqlite", protocol_factory=held)
    run = smarig.load_run(tmp_path / "r.run.sqlite")
    assert run["current_A"].max() == pytest.approx(FLOWS_A)
    assert (run.cause, [e for e in run.events if e.kind == "still_on"]) == ("done", [])
    assert box.flows_A == 0.0


def test_a_box_of_two_roles_is_one_instrument_without_a_clock(bench, tmp_path):
    with Session(str(bench[1])) as session:
        session.run("held", {}, tmp_path / "r.run.sqlite", protocol_factory=held)
        assert "clock of the host" in session.device, "which the instrument's name need not tell"
    (name,) = smarig.load_run(tmp_path / "r.run.sqlite").info.instruments
    assert "clock" not in name


@pytest.mark.parametrize("has_lease", [True, False])
def test_only_a_box_with_a_lease_is_refused_because_of_it(bench, has_lease):
    _, rig = bench
    rig.write_text(rig.read_text().replace("lease_s = 60.0", "lease_s = 0.9"))
    driver = rig.with_name("sticking.py")
    if not has_lease:
        driver.write_text(driver.read_text().replace('self.line.number("SYST:WDOG?")', "-1.0"))
        with Session(str(rig)) as session:
            assert not session.has_lease
        return
    with pytest.raises(ConfigError, match=r"period_s = 0.5 is too long for lease_s = 0.9"), Session(str(rig)):
        pass
