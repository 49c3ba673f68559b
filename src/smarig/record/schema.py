"""The tables of a run file (design contract): names, order, types. Knows no data.

``run`` holds key → value as JSON text; ``sample`` one row a tick, NULL where a channel is absent.
"""

VERSION = 1

SAMPLE_COLUMNS = (
    "tick",
    "t_s",
    "step",
    "current_command_A",
    "current_A",
    "voltage_V",
    "temperature_degC",
    "input",
    "counts",
    "position",
    "ambient_degC",
    "quality",
)
STEP_COLUMNS = (
    "index",
    "attempt",
    "void",
    "branch",
    "target",
    "t_start_s",
    "t_end_s",
    "verdict",
    "position",
    "n",
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

PAGES_BESIDE = 100  # of the write-ahead log, until they go into the file: some tens of seconds at 10 Hz

INSERT_SAMPLE = f"INSERT INTO sample VALUES ({','.join('?' * len(SAMPLE_COLUMNS))})"
INSERT_STEP = f"INSERT OR REPLACE INTO step VALUES ({','.join('?' * len(STEP_COLUMNS))})"
INSERT_EVENT = "INSERT INTO event VALUES (?,?,?,?,?)"
UPSERT_KEY = "INSERT OR REPLACE INTO run VALUES (?,?)"
SHIFT_SAMPLES = """UPDATE sample SET counts = counts + ?, position = position + ?
WHERE tick BETWEEN ? AND ?"""
SHIFT_STEPS = 'UPDATE step SET position = position + ? WHERE "index" >= ?'
VOID_STEPS = "UPDATE step SET void = 1"
DELETE_KEY = "DELETE FROM run WHERE key = ?"
