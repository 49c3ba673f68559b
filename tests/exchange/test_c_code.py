"""The exported C code against the Python operator: bit for bit on random walks, and the same inverse."""

import shutil
import subprocess
import zipfile

import numpy as np
import pytest

from smarig.core.errors import DataError, StorageError, UsageError
from smarig.exchange import export_model
from smarig.exchange.c_code import c_source
from smarig.preisach import FodTable, Mirrored, Preisach, RelayMeasure, thesis_surface

GCC = shutil.which("gcc")
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O2", "-ffp-contract=off"]
SANITIZED = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
MAIN = """
#include "wire.h"
#include <stdio.h>
int main(void) {
    wire_memory m; double x, u; char kind; int found;
    wire_reset(&m, 0);
    while (scanf(" %c %lf", &kind, &x) == 2) {
        if (kind == 's') printf("%a\\n", wire_step(&m, x));
        else if (kind == 'r') printf("%a\\n", wire_reset(&m, (int)x));
        else { found = wire_inverse(&m, x, &u); printf("%d %a\\n", found, u); }
    }
    return 0;
}
"""

needs_gcc = pytest.mark.skipif(GCC is None, reason="needs gcc")


class FakeModel:
    """What the exporter reads of a model."""

    def __init__(self, hysteresis, name="A wire */ \\ with an é"):
        self.hysteresis, self.name, self.unit = hysteresis, name, "mm"
        self.input = type("Input", (), {"unit": "K"})()

    def check_classical(self, purpose):
        pass


def noisy_table(seed=0, n=14):
    """A table whose density is positive."""
    random = np.random.default_rng(seed)
    nodes = np.sort(np.r_[0.0, random.uniform(1, 99, n - 2), 100.0])
    mass = np.tril(random.uniform(0, 1, (n, n)))
    y = np.full((n, n), np.nan)
    for i in range(n):
        for j in range(i + 1):
            y[i, j] = mass[: i + 1, :i].sum() - mass[j : i + 1, j:i].sum() * 0.5 + 0.01 * i
    return FodTable.from_arrays(nodes, nodes, y)


def relays(seed=0, n=200):
    random = np.random.default_rng(seed)
    a, b = np.sort(random.uniform(0, 100, (2, n)), axis=0)[::-1]
    return RelayMeasure.from_arrays(a, b, random.uniform(0, 1, n))


KINDS = {
    "constant": thesis_surface("one_c"),
    "exponential": thesis_surface("one_e"),
    "parabolic": thesis_surface("two_p"),
    "table": noisy_table(),
    "relays": relays(),
    "mirrored": Mirrored(noisy_table(1)),
}


def walk(h, n=3000, seed=0):
    random = np.random.default_rng(seed)
    span = h.upper - h.lower
    wild = random.uniform(h.lower - 0.1 * span, h.upper + 0.1 * span, n)
    nested = h.lower + span * (0.5 + 0.5 * np.linspace(1, 0, n) * np.where(np.arange(n) % 2, 1, -1))
    return np.concatenate([wild, nested[: n // 4], random.permutation(wild)[: n // 4]])


def built(tmp_path, hysteresis, flags=()):
    source = c_source(FakeModel(hysteresis), "wire")
    for name, text in (("wire.h", source.header), ("wire.c", source.source), ("main.c", MAIN)):
        (tmp_path / name).write_text(text, "ascii")
    command = [GCC, *STRICT, *flags, "main.c", "wire.c", "-o", "wire", "-lm"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return tmp_path / "wire"


def answers(program, lines):
    done = subprocess.run([program], input="\n".join(lines), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.splitlines()


@needs_gcc
@pytest.mark.parametrize("kind", KINDS)
def test_outputs_are_those_of_the_operator_to_the_last_bit(tmp_path, kind):
    h = KINDS[kind]
    u = walk(h)
    got = [float.fromhex(a) for a in answers(built(tmp_path, h), [f"s {v!r}" for v in u.tolist()])]
    wire = Preisach(h)
    np.testing.assert_array_equal(got, [wire.step(v) for v in u.tolist()])


@needs_gcc
@pytest.mark.parametrize("kind", KINDS)
def test_the_inverse_is_that_of_the_operator(tmp_path, kind):
    h = KINDS[kind]
    wire, random = Preisach(h), np.random.default_rng(4)
    lines, expected = [], []
    low, high = h.y_lower, h.y_lower + h.everett(h.upper, h.lower)
    for u in walk(h, 120, seed=3).tolist():
        wire.step(u)
        lines.append(f"s {u!r}")
        expected.append(None)
        target = float(random.uniform(low - 0.05 * (high - low), high + 0.05 * (high - low)))
        lines.append(f"i {target!r}")
        try:
            expected.append(wire.inverse(target))
        except DataError as error:
            expected.append("not monotone" if "monotone" in str(error) else "out of range")
    got = answers(built(tmp_path, h, SANITIZED), lines)
    found = 0
    for line, want in zip(got, expected, strict=True):
        if want is None:
            continue
        status, value = line.split()
        if isinstance(want, str):
            assert status == ("2" if want == "not monotone" else "1")
        else:
            assert status == "0"
            assert float.fromhex(value) == want
            found += 1
    assert found > 20


@needs_gcc
def test_a_deeper_nesting_than_the_memory_holds_forgets_the_innermost_loops(tmp_path):
    h = KINDS["table"]
    u = walk(h, 4000)[4000:5000]
    program = built(tmp_path, h, [*SANITIZED, "-DWIRE_EXTREMA=20"])
    got = np.array([float.fromhex(a) for a in answers(program, [f"s {v!r}" for v in u.tolist()])])
    wire = Preisach(h)
    expected = np.array([wire.step(v) for v in u.tolist()])
    np.testing.assert_array_equal(got[:18], expected[:18])
    assert np.isfinite(got).all()


@needs_gcc
def test_nan_moves_nothing_and_saturation_restores_the_memory(tmp_path):
    h = KINDS["table"]
    lines = ["s 50", "s nan", "s 20", "s 1e300", "s 30", "r 0", "s 50", "i nan", "i inf"]
    got = answers(built(tmp_path, h, SANITIZED), lines)
    assert got[0] == got[1] == got[6]
    assert [line.split()[0] for line in got[7:]] == ["3", "3"]


@pytest.mark.parametrize("name", ["", "1st", "a b", "a-b", "é", "x;y", "../x"])
def test_a_name_that_c_does_not_allow_is_refused(name):
    with pytest.raises(UsageError, match="name in C"):
        c_source(FakeModel(KINDS["table"]), name)


def test_hostile_names_stay_in_their_comment(tmp_path):
    source = c_source(FakeModel(KINDS["table"], "*/ int x; /*\n#include <evil.h>"), "wire")
    for text in (source.header, source.source):
        assert "*/ int x" not in text
        assert not [line for line in text.splitlines() if line.startswith("#include <evil")]


# --- FMU ------------------------------------------------------------------------------------------------


@pytest.fixture
def wire_model(tmp_path):
    """A model of a twin's curves."""
    from smarig import identify
    from smarig.record import load_run
    from smarig.runner.session import Session

    with Session("one_wire_twin", seed=3) as session:
        curves = {"partition_K": (0, 50, 70, 90, 110, 160)}
        run = load_run(session.run("first_order_descending", curves, tmp_path / "c.run.sqlite"))
    return identify(run, "exponential").model


def test_an_fmu_passes_validation_and_equals_the_model(tmp_path, wire_model):
    fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed (pip install fmpy)")
    from fmpy.validation import validate_fmu

    (file,) = export_model(wire_model, to="fmu", out=tmp_path / "wire.fmu")
    assert validate_fmu(str(file)) == []
    t = np.arange(0, 60, 0.1)
    u = 80 + 80 * np.sin(t) * np.exp(-t / 40)
    signal = np.array(list(zip(t, u)), dtype=[("time", float), ("input", float)])
    found = fmpy.simulate_fmu(
        str(file), input=signal, output_interval=0.1, stop_time=float(t[-1]), output=["input", "output"]
    )
    expected = wire_model.predict(found["input"])
    assert np.ptp(found["output"]) > 5
    span = np.ptp(expected)
    assert np.abs(found["output"][1:] - expected[1:]).max() < 1e-12 * span
    again = fmpy.simulate_fmu(
        str(file), input=signal, output_interval=0.1, stop_time=1.0, start_values={"start_positive": 1.0}
    )
    assert again["output"][1] > expected[1]


@pytest.mark.long("takes three seconds")
@needs_gcc
def test_the_fmu_compiles_without_a_warning_and_without_undefined_behaviour(tmp_path, wire_model):
    (file,) = export_model(wire_model, to="fmu", out=tmp_path / "wire.fmu")
    with zipfile.ZipFile(file) as archive:
        archive.extractall(tmp_path / "fmu")
    units = [str(tmp_path / "fmu" / "sources" / name) for name in ("wire.c", "fmi2.c")]
    flags = [*STRICT, *SANITIZED, "-fPIC", "-shared"]
    done = subprocess.run([GCC, *flags, *units, "-o", tmp_path / "x.so"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.long("takes three seconds")
def test_an_fmu_without_a_compiler_holds_sources_only(tmp_path, wire_model, monkeypatch):
    monkeypatch.setattr("smarig.exchange.c_code.fmu_archive.shutil.which", lambda name: None)
    (file,) = export_model(wire_model, to="fmu", out=tmp_path / "wire.fmu")
    names = zipfile.ZipFile(file).namelist()
    assert sorted(names) == ["modelDescription.xml", "sources/fmi2.c", "sources/wire.c", "sources/wire.h"]


@pytest.mark.long("takes two seconds")
@needs_gcc
def test_a_failing_compiler_leaves_no_file(tmp_path, wire_model, monkeypatch):
    monkeypatch.setattr("smarig.exchange.c_code.fmu_archive._FLAGS", ("--no-such-flag",))
    with pytest.raises(StorageError, match="compiler"):
        export_model(wire_model, to="fmu", out=tmp_path / "wire.fmu")
    assert not (tmp_path / "wire.fmu").exists()


@pytest.mark.long("takes two seconds")
def test_wrong_endings_and_existing_files_are_refused(tmp_path, wire_model):
    for to, name in (("c", "wire.txt"), ("fmu", "wire.zip")):
        with pytest.raises(UsageError, match="ends in"):
            export_model(wire_model, to=to, out=tmp_path / name)
    export_model(wire_model, to="c", out=tmp_path / "wire.c")
    (tmp_path / "wire.c").unlink()
    with pytest.raises(UsageError, match="exists"):
        export_model(wire_model, to="c", out=tmp_path / "wire.c")
    assert not (tmp_path / "wire.c").exists()
