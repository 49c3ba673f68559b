"""Paths to ``simulators`` and to the helpers of this folder; devices in their own process."""

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
for folder in (str(ROOT), str(Path(__file__).parent)):
    if folder not in sys.path:
        sys.path.insert(0, folder)


class Devices:
    """A running ``python -m simulators``: where its ports are, and its standard input."""

    def __init__(self, *options: str) -> None:
        if "--lock-step" in options and "--gone-after" not in options:
            options += ("--gone-after", "600")  # however long this machine keeps a test waiting
        command = [sys.executable, "-m", "simulators", "--rig", "one_wire_twin", *options]
        self.process = subprocess.Popen(
            command,
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        line = self.process.stdout.readline()
        self.said = json.loads(line) if line else {}

    def url(self, device: str) -> str:
        """Where a device is."""
        return self.said[device]["url"]

    def host_dies(self) -> int:
        """End of its standard input; its exit status."""
        self.process.stdin.close()
        return self.process.wait(timeout=60)

    def end(self) -> None:
        """Stop it, whatever it does."""
        if self.process.poll() is None:
            self.process.terminate()
        self.process.wait(timeout=60)
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            stream.close()


@pytest.fixture
def devices() -> Iterator:
    """A function that starts devices with options."""
    started: list[Devices] = []

    def start(*options: str) -> Devices:
        started.append(Devices(*options))
        return started[-1]

    yield start
    for one in started:
        one.end()
