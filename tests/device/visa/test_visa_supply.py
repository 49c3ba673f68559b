"""Supplies by VISA: the contract in every make's own dialect, watchdogs in real time, dead lines, wrong settings."""

import math
import socket
import time
from pathlib import Path

import pytest

pytest.importorskip("pyvisa_py", reason="the extra visa is not installed")

from simulators.meter import SimulatedMeter
from simulators.supply import SimulatedSupply
from simulators.supply_dialects import DIALECTS
from smarig.config import LinkFile, load_rig
from smarig.core import ConfigError, RigFault, UsageError
from smarig.device import ContractCase, Garbled, PolledSource, Silent, WrongDevice, check_contract
from smarig.device.drivers import _makes
from smarig.device.drivers._makes import makes
from smarig.device.drivers.visa_meter import visa_meter
from smarig.device.drivers.visa_supply import visa_supply
from smarig.device.links.visa_line import VisaLine

pytestmark = pytest.mark.filterwarnings(
    "ignore::UserWarning"
)  # pyvisa-py tells of parts that are not installed
RIG = load_rig("bench_one_wire")  # a lease of 1 s
SPEED = 20.0
WATCHED = ("keysight_n6700", "keysight_n7900")


def link(server, **settings):
    given = {"backend": "@py", **settings}
    return LinkFile(driver="visa_supply", framing="lines", url=server.url, timeout_s=1.0, settings=given)


@pytest.fixture
def serve():
    servers = []

    def made(make, **options):
        servers.append(SimulatedSupply(make, **options))
        return servers[-1]

    yield made
    for server in servers:
        server.close()


ALWAYS = ("keysight_n6700", "keithley_2400", "rigol_dp800", "rohde_schwarz_hmp")  # unlike each other


@pytest.mark.parametrize(
    "make", [m if m in ALWAYS else pytest.param(m, marks=pytest.mark.long) for m in DIALECTS]
)
def test_each_make_meets_the_contract_in_its_own_dialect(make, serve):
    speed = 4.0 if make in WATCHED else SPEED  # a busy machine must not be later than its margin
    server = serve(make, speed=speed)
    absent = link(server).model_copy(update={"url": "TCPIP0::127.0.0.1::9::SOCKET"})
    case = ContractCase(
        lambda: PolledSource(visa_supply(link(server), RIG)),
        lambda: visa_supply(absent, RIG),
        RIG,
        lambda seconds: time.sleep(seconds / speed),
    )
    found = {r.name: r for r in check_contract("amplifier", case)}
    assert [(r.name, r.observed) for r in found.values() if not r.passed] == []
    assert found["lease"].observed.startswith("it has none") == (make not in WATCHED)
    assert server.unknown == [], "commands that the make does not know"
    assert server.limit_V == pytest.approx(5.5, abs=0.6), "of the largest current through the wire"
    assert server.flows_A == 0.0


def test_every_shipped_make_has_a_dialect_here():
    assert set(makes()) - {"scpi"} == set(DIALECTS)


@pytest.mark.parametrize("make", WATCHED)
def test_a_silent_host_leaves_no_current_on(make, serve):
    server = serve(make, speed=4.0)
    supply = visa_supply(link(server), RIG)
    supply.arm()
    assert supply.has_lease
    supply.set_current(0.4)
    assert server.flows_A == 0.4
    time.sleep(2.5 / 4.0)  # a host that was killed says nothing any more
    assert server.flows_A == 0.0
    assert 1.0 <= server.off_after_s < 2.0
    supply.measure()
    assert "switched its output off" in supply.tripped
    supply.close()


def test_a_watchdog_that_does_not_read_back_is_no_lease(serve):
    server = serve("keysight_n6700")
    answer = server.answer
    server.answer = lambda line: "60" if line == "OUTP:PROT:WDOG:DEL?" else answer(line)
    supply = visa_supply(link(server), RIG)
    supply.arm()
    assert supply.has_lease is False


class StuckRelay(SimulatedSupply):
    """Its output stays closed while its state and its setting obey."""

    @property
    def flows_A(self):
        self._closed_A = super().flows_A or getattr(self, "_closed_A", 0.0)
        return self._closed_A


@pytest.mark.parametrize("make", ["rigol_dp800", "keysight_n6700"])
def test_an_output_that_says_off_and_conducts_is_not_confirmed(make):
    server = StuckRelay(make)
    supply = visa_supply(link(server), RIG)
    supply.arm()
    supply.set_current(0.4)
    assert "did not confirm that it is off" in supply.off()
    assert supply.measure().current_A == pytest.approx(0.4, abs=0.01)
    supply.close()
    server.close()


def test_an_output_that_measures_nothing_while_it_is_off_is_off(serve):
    server = serve("rigol_dp800")
    answer = server.answer
    server.answer = lambda line: "9.91E37" if "MEAS" in line and not server.output else answer(line)
    supply = visa_supply(link(server), RIG)
    supply.arm()
    supply.set_current(0.4)
    assert supply.measure().current_A == pytest.approx(0.4, abs=0.01)
    assert supply.off() == ""
    assert supply.measure()[:2] == (0.0, 0.0)
    supply.close()


def test_a_source_meter_is_not_asked_for_a_reading_while_it_is_off(serve):
    server = serve("keithley_2400")
    answer, heard = server.answer, []
    server.answer = lambda line: heard.append((line, server.output)) or answer(line)
    supply = visa_supply(link(server), RIG)
    supply.arm()
    supply.set_current(0.4)
    supply.measure()
    assert supply.off() == ""
    assert {on for line, on in heard if line == ":READ?"} == {True}
    supply.close()


def test_an_output_whose_state_is_garbled_is_not_taken_for_off(serve):
    server = serve("rigol_dp800")
    supply = visa_supply(link(server), RIG)
    supply.arm()
    supply.set_current(0.3)
    answer, garbled = server.answer, ["\x0f1?", "O"]
    server.answer = lambda line: garbled.pop(0) if "OUTP?" in line and garbled else answer(line)
    with pytest.raises(Garbled, match="answers 'O' to :OUTP"):
        supply.measure()
    assert supply.measure().current_A == pytest.approx(0.3, abs=0.01)
    garbled.append("0x")
    assert supply.measure().current_A == pytest.approx(0.3, abs=0.01)
    supply.close()


def test_a_lease_that_the_watchdog_cannot_count_is_refused(serve):
    rig = RIG.model_copy(update={"lease_s": 1.5})
    with pytest.raises(
        ConfigError, match=r"lease_s = 1\.5: the watchdog of this supply counts whole seconds"
    ):
        visa_supply(link(serve("keysight_n6700")), rig)


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({"chanel": 2}, "chanel"),
        ({"make": "keysight"}, "No make 'keysight' of supplies; did you mean keysight"),
        ({"makes": "absent.toml"}, "There is no file absent\\.toml"),
    ],
)
def test_wrong_settings_are_one_sentence(settings, sentence, serve):
    with pytest.raises(Exception, match=sentence) as error:
        visa_supply(link(serve("rigol_dp800"), **settings), RIG)
    assert getattr(error.value, "exit_status", 1) == 2


@pytest.mark.parametrize("backend", ["./notes.txt@ivi", "/tmp/lib.so", "@evil"])
def test_a_rig_file_loads_no_library(backend, serve):
    with pytest.raises(ConfigError, match="backend"):
        visa_supply(link(serve("rigol_dp800"), backend=backend), RIG)


def test_an_unknown_make_names_the_known_ones_and_the_way_out(serve):
    server = serve("rigol_dp800")
    server.identity = "ACME,PS 1,0,0"
    with pytest.raises(
        ConfigError, match=r"of no known make\. The makes are: keysight_e36300, .*settings\.make"
    ):
        visa_supply(link(server), RIG)


def test_a_supply_is_not_for_two_wires_but_a_source_meter_is(serve):
    two = load_rig("bench_two_wire")
    with pytest.raises(ConfigError, match="gives current of one sign only"):
        visa_supply(link(serve("rigol_dp800")), two)
    visa_supply(link(serve("keithley_2400")), two).close()


@pytest.mark.long("takes a second")
def test_a_query_on_a_cut_line_opens_it_again_and_is_asked_once_more(serve):
    server = serve("rigol_dp800")
    supply = visa_supply(link(server), RIG)
    supply.arm()
    supply.set_current(0.3)
    server.drop()
    assert supply.measure().current_A == pytest.approx(0.3)
    line = supply.line
    assert (line.repeats, line.reconnections) == (1, 1)
    server.close()
    with pytest.raises(Silent, match="Check its power, the cable and the port"):
        supply.measure()
    server = serve("rigol_dp800")
    supply = visa_supply(link(server), RIG)
    supply.off()
    supply.close()


def test_a_reply_that_is_no_number_is_asked_once_more(serve, monkeypatch):
    server = serve("rigol_dp800")
    supply = visa_supply(link(server), RIG)
    supply.arm()
    supply.set_current(0.3)
    replies, reply = ["ERR 42"], server._reply
    measured = ("current", "voltage", "both")
    monkeypatch.setattr(
        server, "_reply", lambda action: replies.pop() if replies and action in measured else reply(action)
    )
    assert supply.measure().current_A == pytest.approx(0.3)
    assert supply.line.repeats == 1
    replies += ["ERR 42"] * 2
    with pytest.raises(Garbled, match="answers 'ERR 42'"):
        supply.measure()
    supply.off()
    supply.close()


def test_another_device_at_the_same_address_is_refused(serve):
    server = serve("rigol_dp800")
    supply = visa_supply(link(server), RIG)
    supply.arm()
    server.drop()
    server.identity = "RIGOL TECHNOLOGIES,DP832,ANOTHER,00.01"
    with pytest.raises(WrongDevice, match="instead of"):
        supply.measure()
    assert "did not confirm" in supply.off()


def test_zero_goes_out_first_though_every_reply_is_lost(serve):
    server = serve("rigol_dp800")
    supply = visa_supply(link(server).model_copy(update={"timeout_s": 0.2}), RIG)
    supply.arm()
    supply.set_current(0.3)
    answer, heard = server.answer, []

    def obeys_and_says_nothing(line):
        heard.append(line)
        answer(line)

    server.answer = obeys_and_says_nothing
    with pytest.raises(Silent):
        supply.measure()
    assert server.flows_A == 0.3
    for _ in range(2):
        heard.clear()
        assert "It has no lease: switch it off by hand now." in supply.off()
        assert heard[:2] == [":SOUR1:CURR 0", ":OUTP CH1,OFF"]
        assert server.flows_A == 0.0
    with pytest.raises(Silent):
        supply.set_current(0.4)
    assert (server.level_A, server.flows_A) == (0.0, 0.0), "any other order waits for the identity"
    server.answer = answer
    assert supply.off() == ""
    supply.close()


def test_a_late_answer_is_never_taken_for_the_next(serve):
    server = serve("rigol_dp800")
    supply = visa_supply(link(server).model_copy(update={"timeout_s": 0.2}), RIG)
    supply.arm()
    supply.set_current(0.3)
    server.delay_answers_s = 0.4
    with pytest.raises(Silent):
        supply.measure()
    server.delay_answers_s = 0.0
    now = supply.measure()
    assert (now.current_A, now.voltage_V) == (pytest.approx(0.3), pytest.approx(1.5))
    supply.off()
    supply.close()


def test_a_meter_scales_and_knows_its_range():
    server = SimulatedMeter("MEAS:POS?", lambda: 2.0)
    settings = {"query": "MEAS:POS?", "unit": "mm", "scale": 2.5, "offset": 1.0, "low": 0.0, "high": 10.0}
    meter = visa_meter(link(server, **settings), RIG)
    assert (meter.position(), meter.unit) == (6.0, "mm")
    server.value = lambda: 4.0
    assert math.isnan(meter.position()), "out of range is no reading"
    meter.close()
    server.close()


def test_an_overload_is_no_reading():
    server = SimulatedMeter("READ?", lambda: 1e20)
    meter = visa_meter(link(server, unit="mm"), RIG)
    assert math.isnan(meter.position())
    server.value = lambda: 3.0
    assert meter.position() == 3.0
    meter.close()
    server.close()


def _answering(answer, **settings):
    """A meter that answers READ? with a text, and the server whose text can be changed."""
    server = SimulatedMeter("READ?", lambda: 0.0)
    server.answer = lambda line: "ACME,G7,1,2" if line == "*IDN?" else answer
    return server, visa_meter(link(server, unit="mm", **settings), RIG)


def test_a_number_in_another_unit_than_before_is_no_reading():
    server, meter = _answering("12.5 mm")
    assert meter.position() == 12.5
    server.answer = lambda line: "ACME,G7,1,2" if line == "*IDN?" else "0.4921 in"
    with pytest.raises(Garbled, match=r"answers '0\.4921 in' to READ\?, where a number in mm is expected"):
        meter.position()
    server.answer = lambda line: "ACME,G7,1,2" if line == "*IDN?" else "+12.6 mm"
    assert meter.position() == 12.6
    server.answer = lambda line: "ACME,G7,1,2" if line == "*IDN?" else "9.9E37"
    assert math.isnan(meter.position()), "an overload"
    meter.close()
    server.close()


@pytest.mark.parametrize(
    ("answer", "says"), [("0.5 in", "a number in mm is expected"), ("0.5", "a number in mm is expected")]
)
def test_a_meter_whose_unit_is_stated_gives_no_other(answer, says):
    server, meter = _answering(answer, answer_unit="mm")
    with pytest.raises(Garbled, match=says):
        meter.position()
    meter.close()
    server.close()


@pytest.mark.parametrize("answer", ["1,234", "-12,5 mm"])
def test_a_decimal_comma_is_not_taken_for_two_numbers(answer):
    server, meter = _answering(answer)
    with pytest.raises(Garbled, match=f"answers '{answer}'"):
        meter.position()
    meter.close()
    server.close()


def test_a_meter_of_another_identity_is_refused():
    server, meter = _answering("1", identity="G7")
    meter.close()
    with pytest.raises(WrongDevice, match="answers 'ACME,G7,1,2' to .*, without 'LK-G'"):
        visa_meter(link(server, unit="mm", identity="LK-G"), RIG)
    server.answer = lambda line: "1.25"
    with pytest.raises(WrongDevice, match=r"answers '1\.25' to .*, which is no identity"):
        visa_meter(link(server, unit="mm"), RIG)
    server.close()


def test_an_answer_that_is_no_number_is_garbled(serve):
    server = serve("rigol_dp800")
    meter = visa_meter(link(server, query="*IDN?"), RIG)
    with pytest.raises(Garbled, match="answers 'RIGOL"):
        meter.position()


def test_no_device_and_no_backend_are_one_sentence(serve):
    server = serve("rigol_dp800")
    with pytest.raises(RigFault, match="Connection refused"):
        visa_supply(link(server).model_copy(update={"url": "TCPIP0::127.0.0.1::9::SOCKET"}), RIG)
    with pytest.raises(Exception, match="cannot use the backend '@sim'"):
        visa_supply(link(server, backend="@sim"), RIG)


def test_an_address_that_is_none_is_one_sentence():
    absent = LinkFile(driver="visa_supply", framing="lines", url="/dev/ttyUSB0", settings={"backend": "@py"})
    with pytest.raises(UsageError, match="'/dev/ttyUSB0' is no VISA address, such as TCPIP0::"):
        visa_supply(absent, RIG)


def test_a_voltage_limit_holds_the_current_back(serve):
    server = serve("rigol_dp800", ohm=lambda: 20.0)
    supply = visa_supply(link(server), RIG)
    supply.arm()
    supply.set_current(0.4)
    assert supply.measure().current_A == pytest.approx(server.limit_V / 20.0, abs=1e-5)
    supply.close()


def test_a_line_ends_as_its_link_says():
    with socket.create_server(("127.0.0.1", 0)) as server:
        line = VisaLine(
            f"TCPIP0::127.0.0.1::{server.getsockname()[1]}::SOCKET", 1.0, backend="@py", line_end="\r\n"
        )
        connection, _ = server.accept()
        with connection, connection.makefile("rb") as lines:
            line.write("CURR 0")
            assert lines.readline() == b"CURR 0\r\n"
            connection.sendall(b"ACME,1\r\n")
            assert line.identify() == "ACME,1"
        line.close()


def test_a_query_after_a_command_is_not_held_back(serve):
    """Else each takes the 40 ms after which the command is acknowledged."""
    server = serve("rigol_dp800")
    line = VisaLine(server.url, 1.0, backend="@py")
    line.write(":SOUR1:CURR 0.1")
    assert line.number(":SOUR1:CURR?") == 0.1
    interface = line._manager.visalib.sessions[line._session.session].interface
    assert interface.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
    line.close()


@pytest.mark.parametrize("named", ["scpi", ""])
def test_what_answers_no_identity_is_no_supply(named):
    """A gauge at the address of the supply answers every line with an error."""

    class Gauge(SimulatedMeter):
        def answer(self, line):
            return "ERR1"

    gauge = Gauge("?", lambda: 0.0)
    with pytest.raises(
        WrongDevice, match=rf"^The device at {gauge.url} answers 'ERR1', not an SCPI identity"
    ):
        visa_supply(link(gauge, make=named), RIG)
    gauge.close()


def test_a_make_of_ones_own_needs_no_fields(tmp_path, serve):
    own = tmp_path / "makes.toml"
    text = Path(_makes.__file__).with_name("makes.toml").read_text(encoding="utf-8")
    table = text[text.index("[scpi]") :].split("\n\n")[0].replace("[scpi]", "[mine]")
    own.write_text(table.replace("'$^'", "'^MYBOX'"), encoding="utf-8")
    assert _makes.may_be_supply("MYBOX V2.0", str(own))
    assert not _makes.may_be_supply("ERR1", str(own))
