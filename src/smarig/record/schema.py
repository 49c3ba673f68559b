"""The tables of a run file (design contract): names, order, types. Knows no data.

``run`` holds key → value as JSON text; ``sample`` one row a tick, NULL where a channel is absent.
"""

VERSION = 1

SAMPLE_COLUMNS = (
    "tick",  # the device's integer: this is time
    "t_s",  # tick × period
    "step",  # index of the step it belongs to
    "current_command_A",  # what was asked for
    "current_A",  # what was measured
    "voltage_V",  # at the clamps
    "temperature_degC",  # of the wire, where there is a sensor
    "input",  # what drives the hysteresis: temperature above ambient, a field, …
    "counts",  # raw, of the encoder, since the last zero
    "position",  # the same in the rig's unit
    "ambient_degC",  # of the room
    "quality",  # marks: 0 is good
)
STEP_COLUMNS = (
    "index",  # in the order of the protocol
    "attempt",  # 0, and one more each time it was made again
    "void",  # 1: it was made again and does not count
    "branch",  # what the protocol calls this part
    "target",  # input asked for; NULL for a step that asks for none
    "t_start_s",  # of its first sample
    "t_end_s",  # of its last sample
    "verdict",  # settled, timed_out, elapsed, interrupted
    "position",  # mean over the settle window
    "n",  # samples in that window
)
EVENT_COLUMNS = (
    "t_s",  # when
    "level",  # info, warning, error
    "kind",  # a word
    "text",  # a sentence
    "data",  # figures behind it, JSON
)

CREATE = """
CREATE TABLE run (key TEXT PRIMARY KEY, value TEXT) WITHOUT ROWID;
CREATE TABLE sample (
    tick INTEGER PRIMARY KEY, t_s REAL, step INTEGER, current_command_A REAL, current_A REAL,
    voltage_V REAL, temperature_degC REAL, input REAL, counts INTEGER, position REAL,
    ambient_degC REAL, quality INTEGER NOT NULL DEFAULT 0);
CREATE TABLE step (
    "index" INTEGER, attempt INTEGER, void INTEGER, branch TEXT, target REAL,
    t_start_s REAL, t_end_s REAL, verdict TEXT, position REAL, n INTEGER,
    PRIMARY KEY ("index", attempt));
CREATE TABLE event (t_s REAL, level TEXT, kind TEXT, text TEXT, data TEXT);
"""

WAL_PAGES = 100  # of the write-ahead log, until they go into the file: some tens of seconds at 10 Hz

INSERT_SAMPLE = f"INSERT INTO sample VALUES ({','.join('?' * len(SAMPLE_COLUMNS))})"
INSERT_STEP = f"INSERT OR REPLACE INTO step VALUES ({','.join('?' * len(STEP_COLUMNS))})"
INSERT_EVENT = f"INSERT INTO event VALUES ({','.join('?' * len(EVENT_COLUMNS))})"
UPSERT_KEY = "INSERT OR REPLACE INTO run VALUES (?,?)"
SHIFT_SAMPLES = """UPDATE sample SET counts = counts + ?, position = position + ?
WHERE tick BETWEEN ? AND ?"""
SHIFT_STEPS = 'UPDATE step SET position = position + ? WHERE "index" >= ?'
VOID_STEPS = "UPDATE step SET void = 1"
DELETE_KEY = "DELETE FROM run WHERE key = ?"
