"""An independent client, pymodbus, over both of its transports: reads, writes, function 23, refusals."""

import contextlib

import pytest
from pymodbus.client import ModbusSerialClient, ModbusTcpClient

from smarig.device.encoding.register import load_register_map


@pytest.fixture(params=["modbus_tcp", "modbus_rtu"])
def client(request, devices):
    """Connected to the amplifier."""
    url = devices("--framing", request.param, "--lock-step").url("amplifier")
    if request.param == "modbus_tcp":
        made = ModbusTcpClient("127.0.0.1", port=int(url.rsplit(":", 1)[1]), timeout=30, retries=0)
    else:
        made = ModbusSerialClient(url, baudrate=115200, timeout=30, retries=0)
    assert made.connect()
    with contextlib.closing(made):
        yield made


@pytest.mark.long("takes a second", cases=("modbus_rtu",))
def test_reads_writes_both_and_refusals(client):
    m = load_register_map("amplifier")
    me = {"device_id": m.device.default_address}
    assert client.read_holding_registers(1, count=2, **me).registers == [m.device.kind, m.device.version]
    assert len(client.read_holding_registers(0, count=m.size("status"), **me).registers) == m.size("status")
    assert not client.write_registers(m.start("settings"), [100, 1000], **me).isError()
    assert client.read_holding_registers(m.start("settings"), count=2, **me).registers == [100, 1000]

    def command(sequence, order=0):
        values = [0, sequence, 0, 1, order, 0, 0, 0, 0, 0, 1, 0]  # boot 1 and its nonce, before any order
        return client.readwrite_registers(
            read_address=0, read_count=9, write_address=m.start("command"), values=values, **me
        )

    assert command(41, 1).registers[8] == 41
    assert command(42).registers[0] == 1  # armed
    refused = {
        1: client.write_register(m.start("command"), 7, **me),
        2: client.read_holding_registers(m.size("status"), count=1, **me),
        3: client.write_registers(m.start("command"), [0, 0], **me),
        4: command(43, 1),
    }
    assert {code: reply.exception_code for code, reply in refused.items()} == {code: code for code in refused}
    assert command(44).registers[8] == 44
