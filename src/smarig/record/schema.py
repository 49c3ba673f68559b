"""The tables of a run file: names, order, types.

``run`` holds key → value as JSON text; ``sample`` has one row per tick, NULL for an absent channel.
"""

VERSION = 1

SAMPLE_COLUMNS = (
    "tick",  # the device's integer counter, which defines time
    "t_s",  # tick × period
    "step",  # index of its step
    "current_command_A",  # commanded current
    "current_A",  # measured current
    "voltage_V",  # at the clamps
    "temperature_degC",  # of the wire, if there is a sensor
    "input",  # hysteresis input: temperature above ambient, a field, …
    "counts",  # encoder counts since the last zero
    "position",  # counts in the rig's unit: stored too, so that a reader needs no smarig
    "ambient_degC",  # ambient temperature
    "quality",  # marks: 0 is good
)
STEP_COLUMNS = (
    "index",  # in the order of the protocol
    "attempt",  # 0; one more for each repetition
    "void",  # 1: the step was repeated and does not count
    "branch",  # name of this part in the protocol
    "target",  # target input; NULL for a step without one
    "t_start_s",  # of its first sample
    "t_end_s",  # of its last sample
    "verdict",  # settled, timed_out, elapsed, interrupted, suspect
    "position",  # mean over the settle window
    "n",  # samples in that window
)
EVENT_COLUMNS = (
    "t_s",  # time
    "level",  # info, warning, error; implies the severity none, minor, major
    "kind",  # one word
    "text",  # one sentence
    "data",  # its data, JSON
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

WAL_PAGES = 100  # of the write-ahead log before they move into the file: some tens of seconds at 10 Hz

READ = {  # how the tables are read, and hashed
    "run": "SELECT key, value FROM run ORDER BY key",
    "sample": f"SELECT {','.join(SAMPLE_COLUMNS)} FROM sample ORDER BY tick",
    "step": 'SELECT * FROM step WHERE attempt >= 0 ORDER BY "index", attempt',
    "event": "SELECT * FROM event ORDER BY rowid",
}

READ_SAMPLES_AFTER = f"SELECT {','.join(SAMPLE_COLUMNS)} FROM sample WHERE tick > ? ORDER BY tick"
INSERT_SAMPLE = f"INSERT INTO sample VALUES ({','.join('?' * len(SAMPLE_COLUMNS))})"
INSERT_STEP = f"INSERT OR REPLACE INTO step VALUES ({','.join('?' * len(STEP_COLUMNS))})"
INSERT_EVENT = f"INSERT INTO event VALUES ({','.join('?' * len(EVENT_COLUMNS))})"
UPSERT_KEY = "INSERT OR REPLACE INTO run VALUES (?,?)"
SHIFT_SAMPLES = """UPDATE sample SET counts = counts + ?, position = position + ?
WHERE tick BETWEEN ? AND ?"""
SHIFT_STEPS = 'UPDATE step SET position = position + ? WHERE "index" >= ?'
SUSPECT_STEPS = """UPDATE step SET verdict = 'suspect' WHERE verdict = 'settled' AND t_end_s >= ?"""
VOID_STEPS = "UPDATE step SET void = 1"
DELETE_KEY = "DELETE FROM run WHERE key = ?"
