"""The commands that simulated supplies understand, make by make, and what each does.

They are written apart from the table of the driver (``makes.toml``), whose errors they would otherwise repeat: the
watchdog and the protection bits of Keysight's from its manuals, the others from what is known of them.
"""

import re

NUMBER = r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)"


def dialect(**patterns: str) -> list[tuple[re.Pattern[str], str]]:
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
Commands = tuple[str, list[tuple[re.Pattern[str], str]]]  # the answer to *IDN?, and what follows each command
BOX: Commands = ("smarig,BOX-1,1,1.0", dialect(**PLAIN, clear="outp:prot:cle"))
DIALECTS: dict[str, Commands] = {  # by make
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
