"""A rig whose devices outlive a session: simulated devices that something else has started, behind Modbus TCP."""

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_LINK = """
[links.{device}]
driver = "smarig_{device}"
framing = "modbus_tcp"
url = "{url}"
timeout_s = 5.0
"""


@contextmanager
def started(base: str = "one_wire_twin", *, trace: Path | None = None) -> Iterator[dict[str, str]]:
    """The URL of each device while they run. With a trace, time goes on and the lease trips when the host is gone."""
    words = ["--rig", base, "--framing", "modbus_tcp", "--lock-step", "--gone-after", "1" if trace else "600"]
    words += ["--trace", str(trace)] if trace else []
    with subprocess.Popen(
        [sys.executable, "-m", "simulators", *words],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            said = json.loads(process.stdout.readline())
            yield {device: said[device]["url"] for device in ("amplifier", "encoder_daq")}
        finally:
            process.terminate()
            process.wait()


def rig_file(path: Path, urls: dict[str, str], *, wire: str = "lasting", limits: str = "") -> Path:
    """Write a rig file for devices at these URLs."""
    links = "".join(_LINK.format(device=device, url=url) for device, url in urls.items())
    path.write_text(
        f'name = "{path.stem}"\nbase = "one_wire_modbus_tcp"\nwire = "{wire}"\n{links}'
        f"[simulator]\nstart = false\n{limits}",
        encoding="utf-8",
    )
    return path
