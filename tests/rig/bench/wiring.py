"""Devices that differ from the rig file: lines exchanged, other firmware, network ports in between."""

import contextlib
import os
import re
import selectors
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pytest
from serial import rfc2217

OTHER_MAP = """
import smarig.core.resources as resources
from pathlib import Path
shipped = resources.shipped
resources.shipped = lambda name: Path({folder!r}) if name == "firmware_protocol" else shipped(name)
"""


def exchanged(urls: dict) -> dict:
    """Each device at the other's port."""
    return {**urls, "amplifier": urls["encoder_daq"], "encoder_daq": urls["amplifier"]}


def other_firmware(patch: pytest.MonkeyPatch, folder: Path) -> None:
    """Simulated devices take their maps from a copy of the next version."""
    maps = folder / "firmware_protocol"
    maps.mkdir()
    for path in opening_maps():
        text = re.sub(r"(?m)^(version|since) = \d+", r"\1 = 99", path.read_text())
        (maps / path.name).write_text(text)
    (folder / "sitecustomize.py").write_text(OTHER_MAP.format(folder=str(maps)))
    patch.setenv("PYTHONPATH", str(folder))


def opening_maps() -> list[Path]:
    """The register maps that this smarig goes by."""
    from smarig.core.resources import shipped

    return sorted(shipped("firmware_protocol").glob("*.toml"))


@contextmanager
def rewired(patch: pytest.MonkeyPatch, how: Callable[[dict], dict]) -> Iterator[None]:
    """What the simulated devices say of where they are passes through ``how``."""
    process = import_module("smarig.rig.simulator_process")
    ready = process._ready
    patch.setattr(process, "_ready", lambda *given: how(ready(*given)))
    yield


class Relays:
    """One TCP port in front of each pty; ``scheme`` is socket or rfc2217."""

    def __init__(self, scheme: str) -> None:
        self.scheme, self._threads, self._listeners = scheme, [], []

    def __call__(self, urls: dict) -> dict:
        """The same devices, behind network ports."""
        return {name: {"url": self._in_front_of(urls[name]["url"])} for name in ("amplifier", "encoder_daq")}

    def _in_front_of(self, path: str) -> str:
        listener = socket.create_server(("127.0.0.1", 0))
        listener.settimeout(0.1)
        thread = threading.Thread(target=self._serve, args=(listener, path), daemon=True)
        self._listeners.append(listener)
        self._threads.append(thread)
        thread.start()
        return f"{self.scheme}://127.0.0.1:{listener.getsockname()[1]}"

    def _serve(self, listener: socket.socket, path: str) -> None:
        with contextlib.suppress(OSError):  # the listener was closed: the end
            while listener.fileno() >= 0:
                with contextlib.suppress(TimeoutError), listener.accept()[0] as host:
                    host.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                    _relay(host, path, telnet=self.scheme == "rfc2217")

    def close(self) -> None:
        """Listen no more."""
        for listener in self._listeners:
            listener.close()
        for thread in self._threads:
            thread.join(5)


def _relay(host: socket.socket, path: str, *, telnet: bool) -> None:
    """Bytes both ways until one side has ended."""
    try:
        device = os.open(path, os.O_RDWR | os.O_NOCTTY)
    except OSError:
        return
    manager = rfc2217.PortManager(_settings(), _Connection(host)) if telnet else None
    try:
        with selectors.DefaultSelector() as both:
            both.register(host, selectors.EVENT_READ)
            both.register(device, selectors.EVENT_READ)
            while True:
                for key, _ in both.select():
                    if not _passed(key.fileobj, host, device, manager):
                        return
    except OSError:
        return
    finally:
        os.close(device)


def _passed(source: object, host: socket.socket, device: int, manager: rfc2217.PortManager | None) -> bool:
    """Whether there was anything."""
    if source is host:
        data = host.recv(4096)
        os.write(device, b"".join(manager.filter(data)) if manager else data)
    else:
        data = os.read(device, 4096)
        host.sendall(b"".join(manager.escape(data)) if manager else data)
    return bool(data)


class _Connection:
    """Passes the data of a PortManager to the host."""

    def __init__(self, host: socket.socket) -> None:
        self.write = host.sendall


def _settings() -> SimpleNamespace:
    """A port's settings, kept and otherwise without effect: a pty has no speed and no modem lines."""
    return SimpleNamespace(
        baudrate=115200,
        bytesize=8,
        parity="N",
        stopbits=1,
        xonxoff=False,
        rtscts=False,
        dtr=True,
        rts=True,
        cts=True,
        dsr=True,
        ri=False,
        cd=True,
        break_condition=False,
        reset_input_buffer=lambda: None,
        reset_output_buffer=lambda: None,
    )
