"""Laboratory supplies on a TCP port, each in the dialect of its manual, with a watchdog in real time.

The dialects are written apart from the table of the driver: the watchdog and the protection bits of Keysight's from its
manuals, the others from what is known of them. A command that a dialect does not know is kept in ``unknown``.
"""

import re
import socket
import threading
import time

OHM = 5.0
NUMBER = r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)"


def dialect(**patterns):
    """Regular expressions by action; SCPI ignores case and a leading colon."""
    return [(re.compile(f":?{p}$", re.IGNORECASE), action) for action, p in patterns.items()]


AT = r"\s*,\s*\(@1\)"
KEYSIGHT = {
    "set_current": rf"curr {NUMBER}{AT}",
    "setting": r"curr\? \(@1\)",
    "limit": rf"volt {NUMBER}{AT}",
    "on": rf"outp (?:on|1){AT}",
    "off": rf"outp (?:off|0){AT}",
    "is_on": r"outp\? \(@1\)",
    "current": r"meas:curr\? \(@1\)",
    "voltage": r"meas:volt\? \(@1\)",
    "clear": r"outp:prot:cle \(@1\)",
    "no_ocp": rf"curr:prot:stat off{AT}",
}
PLAIN = {
    "set_current": f"curr {NUMBER}",
    "setting": r"curr\?",
    "limit": f"volt {NUMBER}",
    "on": "outp(?::stat)? (?:on|1)",
    "off": "outp(?::stat)? (?:off|0)",
    "is_on": r"outp(?::stat)?\?",
    "current": r"meas:curr\?",
    "voltage": r"meas:volt\?",
}
WATCHDOG = {
    "delay": r"outp:prot:wdog:del (\d+)",
    "watch": "outp:prot:wdog on",
    "watched": r"outp:prot:wdog\?",
    "delay_of": r"outp:prot:wdog:del\?",
}
OUT1 = "inst out1;"
DIALECTS = {
    "keysight_e36300": ("Keysight Technologies,E36312A,MY1,1.0", dialect(**KEYSIGHT)),
    "keysight_n6700": (
        "Keysight Technologies,N6702C,MY1,E.02",
        dialect(**KEYSIGHT, **WATCHDOG, status=r"stat:ques:cond\? \(@1\)"),
    ),
    "keysight_n7900": (
        "Keysight Technologies,N7950A,MY1,A.01",
        dialect(
            **{k: v for k, v in PLAIN.items() if k not in ("set_current", "setting")},
            **WATCHDOG,
            set_current=f"curr:lim {NUMBER}",
            setting=r"curr:lim\?",
            clear="outp:prot:cle",
            mode="func volt",
            status=r"stat:ques1:cond\?",
        ),
    ),
    "keithley_2200": ("Keithley Instruments,2200-20-5,1,1.2", dialect(**PLAIN, remote="syst:rem")),
    "keithley_2400": (
        "KEITHLEY INSTRUMENTS INC.,MODEL 2400,1,C30",
        dialect(
            set_current=f"sour:curr {NUMBER}",
            setting=r"sour:curr\?",
            limit=f"sens:volt:prot {NUMBER}",
            on="outp on",
            off="outp off",
            is_on=r"outp\?",
            both=r"read\?",
            function="sour:func curr",
            mode="sour:curr:mode fix",
            range=f"sour:curr:rang {NUMBER}",
            sense="sens:func 'volt'",
            auto="sens:volt:rang:auto on",
            form="form:elem volt,curr",
        ),
    ),
    "rigol_dp800": (
        "RIGOL TECHNOLOGIES,DP832,DP8A1,00.01",
        dialect(
            set_current=f"sour1:curr {NUMBER}",
            setting=r"sour1:curr\?",
            limit=f"sour1:volt {NUMBER}",
            on="outp ch1,on",
            off="outp ch1,off",
            is_on=r"outp\? ch1",
            current=r"meas:curr\? ch1",
            voltage=r"meas:volt\? ch1",
            no_ocp="outp:ocp ch1,off",
        ),
    ),
    "tdk_lambda_z": ("TDK-LAMBDA,Z20-10-LAN,1,Z:01.0", dialect(**PLAIN, remote="syst:rem rem")),
    "rohde_schwarz_hmp": (
        "ROHDE&SCHWARZ,HMP4040,1,HW5",
        dialect(
            set_current=OUT1 + f"curr {NUMBER}",
            setting=OUT1 + r"curr\?",
            limit=OUT1 + f"volt {NUMBER}",
            on=OUT1 + "outp:sel 1;outp:gen 1",
            off=OUT1 + "outp:sel 0",
            is_on=OUT1 + r"outp:sel\?",
            current=OUT1 + r"meas:curr\?",
            voltage=OUT1 + r"meas:volt\?",
        ),
    ),
}
WORDS = ("rigol_dp800", "tdk_lambda_z")  # these answer ON and OFF
QUERIES = ("setting", "is_on", "current", "voltage", "both", "watched", "delay_of", "status")


class ScpiServer:
    """One supply. ``speed``: its seconds per second; ``honest`` watchdogs act. ``position``: answered to MEAS:POS?."""

    def __init__(self, make, speed=1.0, honest=True, drive=None, position=None):
        self.identity, self._dialect = DIALECTS[make]
        self._make, self.speed, self.honest = make, speed, honest
        self.drive, self.position = drive or (lambda current_A: None), position
        self.level_A, self.output, self.limit_V, self.protected = 0.0, False, None, 0
        self.delay_s, self.watching, self.fed_s = 60, False, time.monotonic()
        self.off_after_s = None  # of its own seconds after the last command, when the watchdog acted
        self.unknown, self.heard = [], []
        self.delay_answers_s = 0.0
        self._lock = threading.Lock()
        self._server = socket.create_server(("127.0.0.1", 0))
        self._over = threading.Event()
        self._connections = []
        for target in (self._accept, self._watch):
            threading.Thread(target=target, daemon=True).start()

    @property
    def url(self):
        return f"TCPIP0::127.0.0.1::{self._server.getsockname()[1]}::SOCKET"

    @property
    def flows_A(self):
        with self._lock:
            return self.level_A if self.output and not self.protected else 0.0

    def _accept(self):
        while not self._over.is_set():
            try:
                connection, _ = self._server.accept()
            except OSError:
                return
            self._connections.append(connection)
            threading.Thread(target=self._talk, args=(connection,), daemon=True).start()

    def _talk(self, connection):
        buffer = b""
        try:
            while data := connection.recv(4096):
                buffer += data
                while b"\n" in buffer:
                    line, buffer = buffer.split(b"\n", 1)
                    answer = self.answer(line.decode().strip())
                    if answer is not None:
                        time.sleep(self.delay_answers_s)
                        connection.sendall(f"{answer}\n".encode())
        except OSError:
            return

    def answer(self, line):
        with self._lock:
            self.fed_s = time.monotonic()
            self.heard.append(line)
            found = self._answer(line)
            flowing = self.level_A if self.output and not self.protected else 0.0
        self.drive(flowing)
        return found

    def _answer(self, line):
        if line.upper() == "*IDN?":
            return self.identity
        if line == "MEAS:POS?" and self.position is not None:
            return f"{self.position():.5f}"
        for pattern, action in self._dialect:
            match = pattern.match(line)
            if match:
                return self._act(action, *match.groups())
        self.unknown.append(line)
        return None

    def _act(self, action, value="0"):
        flows_A = self.level_A if self.output and not self.protected else 0.0
        flag = ("ON", "OFF") if self._make in WORDS else ("1", "0")
        if action in QUERIES:
            return {
                "setting": f"{self.level_A:.6f}",
                "is_on": flag[not self.output],
                "current": f"{flows_A:.6E}",
                "voltage": f"{OHM * flows_A:.6E}",
                "both": f"{OHM * flows_A:.6E},{flows_A:.6E}",
                "watched": str(int(self.watching)),
                "delay_of": str(self.delay_s),
                "status": str(self.protected),
            }[action]
        if action == "set_current":
            self.level_A = float(value)
        elif action == "limit":
            self.limit_V = float(value)
        elif action in ("on", "off"):
            self.output = action == "on"
        elif action == "delay":
            self.delay_s = int(value)
        elif action == "watch":
            self.watching = True
        elif action == "clear":
            self.protected = 0
        return None

    def _watch(self):
        while not self._over.wait(0.002):
            with self._lock:
                silent_s = (time.monotonic() - self.fed_s) * self.speed
                acts = self.watching and self.honest and self.output and not self.protected
                if acts and silent_s > self.delay_s:
                    self.protected = 2048  # latched; the programmed state stays
                    self.off_after_s = silent_s
            if self.protected:
                self.drive(0.0)

    def drop(self):
        """Cut every connection."""
        for connection in self._connections:
            connection.close()
        self._connections.clear()

    def close(self):
        self._over.set()
        self._server.close()
        self.drop()
