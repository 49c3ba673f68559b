"""A console in a process of its own, and requests to it as a browser or an attacker makes them."""

import http.client
import os
import re
import select
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

LONGEST_S = 90.0


class Reply(NamedTuple):
    status: int
    headers: dict[str, str]
    body: str


class Console(NamedTuple):
    process: subprocess.Popen
    port: int
    token: str

    @property
    def own(self) -> dict[str, str]:
        """The headers of a page of the console."""
        return {
            "Cookie": f"smarig-console-{self.port}={self.token}",
            "Origin": f"http://127.0.0.1:{self.port}",
        }

    def ask(self, path: str, method: str = "GET", headers: dict[str, str] | None = None, body=None) -> Reply:
        """A request with exactly these headers; with those of the console itself if there are none."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=LONGEST_S)
        try:
            connection.request(method, path, body, self.own if headers is None else headers)
            reply = connection.getresponse()
            names = {name.lower(): value for name, value in reply.getheaders()}
            return Reply(reply.status, names, reply.read().decode())
        finally:
            connection.close()


@contextmanager
def started_console(folder: Path, *more: str) -> Iterator[Console]:
    """``smarig console`` for a folder; killed at the end if it still runs."""
    command = [sys.executable, "-m", "smarig", "console", "--folder", str(folder), "--no-browser", *more]
    process = subprocess.Popen(command, env=os.environ, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE)
    try:
        text, end = b"", time.monotonic() + LONGEST_S
        while not (found := re.search(rb"http://127\.0\.0\.1:(\d+)/\?token=(\S+)\s", text)):
            assert time.monotonic() < end, text
            if select.select([process.stderr], [], [], 1)[0]:
                part = os.read(process.stderr.fileno(), 4096)
                assert part, text
                text += part
        yield Console(process, int(found[1]), found[2].decode())
    finally:
        process.kill()
        process.communicate()
