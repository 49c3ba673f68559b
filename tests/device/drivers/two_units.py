"""Two devices behind one pty, which reply to a read of two words with their address."""

import os
import pty
import select
import threading
import tty

from smarig.config import LinkFile
from smarig.device.encoding.crc import crc16

REQUEST_BYTES = 8


def where(two: "Two", baud: int = 115200) -> LinkFile:
    """The link of a rig file."""
    return LinkFile(driver="smarig_amplifier", framing="modbus_rtu", url=two.path, baud=baud, timeout_s=0.3)


class Two:
    """Addresses 65 and 100. While ``late``, replies wait until the next request."""

    def __init__(self) -> None:
        self._ours, self._theirs = pty.openpty()
        tty.setraw(self._ours)
        tty.setraw(self._theirs)
        self.path, self.late = os.ttyname(self._theirs), False
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._serve)

    def __enter__(self) -> "Two":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()
        os.close(self._ours)
        os.close(self._theirs)

    def _serve(self) -> None:
        heard, kept = b"", b""
        while not self._over.is_set():
            if not select.select([self._ours], [], [], 0.02)[0]:
                continue
            heard += os.read(self._ours, 4096)
            while len(heard) >= REQUEST_BYTES:
                request, heard = heard[:REQUEST_BYTES], heard[REQUEST_BYTES:]
                body = bytes([request[0], 3, 4, 0, request[0], 0, request[0]])
                kept += body + crc16(body).to_bytes(2, "little")
                if not self.late:
                    os.write(self._ours, kept)
                    kept = b""
