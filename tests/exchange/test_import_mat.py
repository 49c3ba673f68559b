"""MATLAB files: variables become columns, matrices become numbered loops, and everything else is refused."""

import io
import struct
import zlib

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from scipy.io import loadmat, savemat

from smarig.core.errors import ConfigError, DataError, SmarigError, UsageError
from smarig.exchange.binary import mat_file
from smarig.exchange.binary.mat_file import open_mat

MAPPING = """
name = "made"
summary = "A test."
source = "this test"
[mat]
[columns]
input = { column = "H", unit = "Oe" }
position = { column = "B", unit = "mT", scale = 2.0 }
[input]
channel = "input"
quantity = "magnetic field"
unit = "A/m"
[output]
quantity = "flux density"
unit = "T"
"""
LOOPS = MAPPING.replace("[mat]", '[mat]\nloops = "columns"')
PAIR = MAPPING.replace("[mat]", '[mat]\nfiles = ["H_*.mat", "B_*.mat"]')
H = np.array([1.0, 0.0, -1.0, 0.0, 1.0])
B = np.array([400.0, 100.0, -400.0, -100.0, 400.0])


def matlab(compressed=False, **variables) -> bytes:
    """A MATLAB 5 file's bytes, as scipy writes them."""
    out = io.BytesIO()
    savemat(out, variables, do_compression=compressed)
    return out.getvalue()


@pytest.fixture
def mapped(write, imported):
    """Import a file's bytes through a mapping given as text."""

    def do(data, mapping=MAPPING, name="data.mat", **options):
        path = write(data, name)
        return imported(path, "mat", mapping=str(write(mapping, "map.toml")), **options)

    return do


# --- what becomes of the variables ------------------------------------------------------------------------


@pytest.mark.parametrize("compressed", [False, True])
def test_vectors_become_columns_in_the_units_of_the_mapping(mapped, compressed):
    run = mapped(matlab(compressed, H=H, B=B[:, None]))
    np.testing.assert_allclose(run["input"], 79.57747154594767 * H)
    np.testing.assert_allclose(run["position"], 2e-3 * B)
    assert (run.input_unit, run.unit) == ("A/m", "T")
    assert not run.has("step")
    assert not run.has("t_s")
    assert run.meta["imported"]["format"] == "mat"


@pytest.mark.parametrize("kind", ["int16", "single", "uint8"])
def test_numbers_of_any_class_are_numbers(mapped, kind):
    run = mapped(matlab(H=np.array([1, 0, 2], kind), B=np.array([100, 0, 200], kind)))
    assert run["position"].tolist() == [0.2, 0.0, 0.4]


@pytest.mark.parametrize("way", ["columns", "rows"])
def test_each_column_or_row_is_a_loop_with_its_number(mapped, way):
    h, b = np.outer([1, 2, 3], H), np.outer([1, 3, 9], B)  # three loops of five readings
    if way == "columns":
        h, b = h.T, b.T
    run = mapped(matlab(H=h, B=b), LOOPS.replace("columns", way, 1))
    assert run["step"].tolist() == [0] * 5 + [1] * 5 + [2] * 5
    np.testing.assert_allclose(run["position"][run["step"] == 2], 9 * 2e-3 * B)
    np.testing.assert_allclose(run["input"].reshape(3, 5).max(axis=1), 79.57747 * np.array([1, 2, 3]), 1e-6)
    assert run.steps == ()  # loops are no settled steps: every reading is a point
    assert run.points()[0].size == 15


def test_faults_are_sought_in_each_loop_by_itself(mapped):
    t = np.linspace(0, 2 * np.pi, 201)
    h = np.cos(t)
    b = np.cos(t - 0.3)  # lags: closed, and nothing odd
    small_and_large = mapped(matlab(H=np.c_[h, 10 * h], B=np.c_[b, 10 * b]), LOOPS)
    assert small_and_large.meta["warnings"] == []  # the way from loop to loop is no jump
    drifting = mapped(matlab(H=np.c_[h, 10 * h], B=np.c_[b, 10 * b + t]), LOOPS)
    said = [w for w in drifting.meta["warnings"] if "does not close" in w]
    assert len(said) == 1
    assert said[0].startswith("Loop 1: At the high end of the input the output goes")


def test_missing_readings_stay_missing_and_are_counted(mapped):
    b = B.copy()
    b[3] = np.nan
    run = mapped(matlab(H=H, B=b))
    assert np.isnan(run["position"]).nonzero()[0].tolist() == [3]
    assert "Variable 'B': 1 of 5 numbers are NaN." in run.meta["warnings"]


def test_the_mapping_may_name_the_state_the_run_began_in(mapped):
    assert mapped(matlab(H=H, B=B), 'initial = "anhysteretic"' + MAPPING).meta["initial"] == "anhysteretic"
    assert "initial" not in mapped(matlab(H=H, B=B)).meta


# --- the format itself, packed by hand from its specification ---------------------------------------------


def element(order, kind, payload) -> bytes:
    """One element of a MATLAB 5 file: in its own tag up to four bytes, else padded to eight."""
    if 0 < len(payload) <= 4:
        return struct.pack(order + "I", len(payload) << 16 | kind) + payload.ljust(4, b"\0")
    return struct.pack(order + "II", kind, len(payload)) + payload.ljust(-(-len(payload) // 8) * 8, b"\0")


def variable(order, name, code, *parts) -> bytes:
    """A variable: flags with its class, then size, name and numbers as they come."""
    flags = element(order, 6, struct.pack(order + "II", code, 0))
    return element(order, 14, flags + b"".join(element(order, *p) for p in parts))


def hand_made(order, *variables) -> bytes:
    mark = b"IM" if order == "<" else b"MI"
    return b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack(order + "H", 0x100) + mark + b"".join(variables)


@pytest.mark.parametrize("order", ["<", ">"])
def test_either_byte_order_and_numbers_kept_in_a_smaller_type(mapped, order):
    size = (5, struct.pack(order + "ii", 3, 1))
    h = variable(order, "H", 6, size, (1, b"H"), (3, struct.pack(order + "3h", 0, -300, 300)))
    b = variable(order, "B", 7, size, (1, b"B"), (1, struct.pack("3b", 0, -5, 5)))
    run = mapped(hand_made(order, h, b))
    np.testing.assert_allclose(run["input"], 79.57747154594767 * np.array([0, -300, 300]))
    np.testing.assert_allclose(run["position"], [0, -0.01, 0.01])


def test_objects_of_newer_matlabs_and_its_bookkeeping_do_not_hide_the_numbers(mapped):
    size = (5, struct.pack("<ii", 1, 2))
    h, b = (variable("<", n, 6, size, (1, n.encode()), (9, struct.pack("<2d", 0, 1))) for n in "HB")
    opaque = variable("<", "table", 17, (1, b"measured"), (1, b"MCOS"), (1, b"table"))
    nameless = variable("<", "", 9, (5, struct.pack("<ii", 1, 8)), (1, b""), (2, bytes(8)))
    data = hand_made("<", h, opaque, b, nameless)
    assert len(mapped(data, MAPPING + '[ignore]\nmeasured = "a table"\n')) == 2
    with pytest.raises(DataError, match="'measured' is of MATLAB class opaque"):
        mapped(data, MAPPING.replace('"H"', '"measured"') + '[ignore]\nH = ""\n')


# --- two files that belong together -----------------------------------------------------------------------


@pytest.mark.parametrize("given_file", ["H_x.mat", "B_x.mat"])
def test_either_of_two_files_brings_the_other(write, imported, given_file):
    write(matlab(H=H), "H_x.mat")
    write(matlab(B=B), "B_x.mat")
    write(matlab(B=-B), "B_y.mat")  # of another pair
    mapping = str(write(PAIR, "map.toml"))
    run = imported(write(b"", "map2.toml").with_name(given_file), "mat", mapping=mapping)
    np.testing.assert_allclose(run["position"], 2e-3 * B)
    other = ({"H_x.mat", "B_x.mat"} - {given_file}).pop()
    assert list(run.meta["companions"]) == [other]
    assert len(run.meta["companions"][other]) == 64


def test_a_missing_or_misnamed_file_of_a_pair_is_named(write, mapped):
    with pytest.raises(
        UsageError, match=r"H_x\.mat must be read together with B_x\.mat, which is not in the same folder"
    ):
        mapped(matlab(H=H), PAIR, "H_x.mat")
    with pytest.raises(UsageError, match=r"named H_\*\.mat and B_\*\.mat; .*M_x\.mat is none of them"):
        mapped(matlab(H=H), PAIR, "M_x.mat")
    write(matlab(H=H, B=B), "B_x.mat")
    with pytest.raises(DataError, match=r"'H' is in .*H_x\.mat and in .*B_x\.mat\. Keep one of them"):
        mapped(matlab(H=H), PAIR, "H_x.mat")


# --- what is refused, in one sentence ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("variables", "mapping", "said"),
    [
        ({"H": H}, MAPPING, r"no variable 'B', which mapping made uses as position\. The file has: H"),
        ({"H": H, "B": B, "T": B}, MAPPING, "variable 'T' is not in mapping made"),
        ({"H": H, "B": B[:-1]}, MAPPING, "'H' and 'B' differ in size, 1 × 5 and 1 × 4"),
        ({"H": np.outer(H, [1, 2]), "B": np.outer(B, [1, 2, 3])}, LOOPS, "in size, 5 × 2 and 5 × 3"),
        ({"H": np.outer(H, [1, 2]), "B": np.outer(B, [1, 2])}, MAPPING, r"5 × 2, a vector.*\[mat\] loops ="),
        ({"H": H[:1], "B": B[:1]}, MAPPING, r"holds 1 reading\(s\) per loop"),
        ({"H": "five", "B": B}, MAPPING, "'H' is of MATLAB class char; a matrix of numbers"),
        ({"H": np.array([1, "a"], dtype=object), "B": B}, MAPPING, "'H' is of MATLAB class cell"),
        ({"H": {"x": 1.0}, "B": B}, MAPPING, "'H' is of MATLAB class struct"),
        ({"H": H > 0, "B": B}, MAPPING, "'H' is of MATLAB class logical"),
        ({"H": H + 1j, "B": B}, MAPPING, "'H' is of MATLAB class complex double"),
        ({"H": np.ones((2, 2, 2)), "B": B}, MAPPING, "'H' is 2 × 2 × 2"),
        ({"H": np.ones((0, 0)), "B": B}, MAPPING, "'H' is 0 × 0"),
        ({"H": np.where(H < 0, np.inf, H), "B": B}, MAPPING, "'H' is infinite in row 1, column 3"),
        ({}, MAPPING, "without any variable"),
    ],
)
def test_variables_that_do_not_fit_the_mapping_are_refused(mapped, variables, mapping, said):
    with pytest.raises((DataError, ConfigError), match=said) as caught:
        mapped(matlab(**variables), mapping)
    assert "\n" not in str(caught.value)
    assert "data.mat" in str(caught.value)


def test_variables_nobody_needs_may_be_of_any_kind_when_the_mapping_ignores_them(mapped):
    extra = {"who": "me", "cell": np.array([1, "a"], dtype=object)}
    run = mapped(matlab(H=H, B=B, **extra), MAPPING + '[ignore]\nwho = "a name"\ncell = "a list"\n')
    assert len(run) == 5


HEADER_5 = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + b"\x89HDF\r\n\x1a\n", "Save it .* '-v7'"),
        (b"\x89HDF\r\n\x1a\n" + bytes(600), "7.3"),
        (b"H,B\n1,2\n", "not a MATLAB 5 file"),
        (b"", "not a MATLAB 5 file"),
        (HEADER_5, "without any variable"),
        (HEADER_5[:-2], "damaged"),
        (HEADER_5 + b"\x0f\x00\x00\x00", "damaged"),
        (HEADER_5 + struct.pack("<II", 15, 9) + b"not a zip", "damaged"),
        (HEADER_5 + struct.pack("<II", 14, 99) + b"short", "damaged"),
    ],
)
def test_what_is_no_matlab_5_file_is_refused(mapped, data, said):
    with pytest.raises(DataError, match=said) as caught:
        mapped(data)
    assert "\n" not in str(caught.value)


def test_a_variable_held_twice_is_refused(mapped):
    once = matlab(H=H, B=B)
    with pytest.raises(DataError, match="'H' more than once"):
        mapped(once + matlab(H=-H)[128:])


@pytest.mark.parametrize("compressed", [False, True])
def test_a_file_cut_anywhere_is_refused(mapped, compressed):
    whole = matlab(compressed, H=H, B=B)
    for end in range(len(whole) - 1, 0, -17):
        with pytest.raises((DataError, ConfigError)) as caught:  # between variables: one is missing
            mapped(whole[:end])
        assert "data.mat" in str(caught.value)


def test_a_small_file_that_inflates_without_end_is_refused_before_it_fills_the_memory(mapped, monkeypatch):
    monkeypatch.setattr(mat_file, "MAX_BYTES", 100_000)
    bomb = zlib.compress(bytes(10_000_000))
    with pytest.raises(DataError, match=r"more than 0 MB of numbers\. Split it"):
        mapped(HEADER_5 + struct.pack("<II", 15, len(bomb)) + bomb)
    with pytest.raises(DataError, match="Split it into smaller files"):
        mapped(matlab(H=np.ones(20_000), B=np.ones(20_000)))


def test_every_kind_of_too_much_is_refused(mapped, monkeypatch):
    monkeypatch.setattr(mat_file, "MAX_BYTES", 100_000)
    with pytest.raises(DataError, match="Split it into smaller files"):
        mapped(HEADER_5 + bytes(200_000))  # on the disk
    small = np.ones(20_000, np.int8)
    with pytest.raises(DataError, match="Split it into smaller files"):
        mapped(matlab(H=small, B=small))  # eight times as large once they are numbers to reckon with


def test_damage_is_found_where_the_numbers_would_still_come_out(mapped):
    honest = matlab(H=H, B=B)
    packed = zlib.compress(matlab(H=H)[128:])
    for cut in (packed[:-1], packed[:-4] + b"\0\0\0\0"):  # the checksum gone, or wrong
        with pytest.raises(DataError, match="damaged"):
            mapped(honest[:128] + struct.pack("<II", 15, len(cut)) + cut + matlab(B=B)[128:])
    with pytest.raises(DataError, match="damaged"):  # the cut is in a variable nobody needs
        mapped(matlab(H=H, B=B, T=B)[:-8], MAPPING + '[ignore]\nT = "nothing"\n')
    with pytest.raises(DataError, match="damaged"):  # an element of another kind in the place of a variable
        mapped(honest[:128] + struct.pack("<I", 13) + honest[132:])
    size = (5, struct.pack("<ii", 1, 5))
    five = element("<", 6, struct.pack("<II", 6, 0)) + element("<", *size) + element("<", 1, b"H")
    in_its_tag = struct.pack("<I", 5 << 16 | 1) + bytes(12)
    with pytest.raises(DataError, match="damaged"):
        mapped(hand_made("<", element("<", 14, five + in_its_tag)) + matlab(B=B)[128:])


def test_a_size_beyond_the_file_is_refused(mapped):
    honest = matlab(H=H, B=B)
    at = honest.index(struct.pack("<ii", 1, 5))  # the dimensions of H
    for rows, columns in [(2**31 - 1, 2**31 - 1), (1, 10**9), (-1, 5), (1, 6)]:
        with pytest.raises(DataError):
            mapped(honest[:at] + struct.pack("<ii", rows, columns) + honest[at + 8 :])


WHOLE = matlab(H=H, B=B)


@settings(max_examples=300, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(st.integers(0, len(WHOLE) - 1), st.integers(0, 255)), min_size=1, max_size=4))
@example([(len(WHOLE) - 5, 1)])
def test_any_damage_is_read_or_refused(tmp_path, damage):
    bytes_ = bytearray(WHOLE)
    for at, value in damage:
        bytes_[at] = value
    path = tmp_path / "fuzz.mat"
    path.write_bytes(bytes_)
    try:
        file = open_mat(path)
        matrices = [file.matrix(name) for name in file.variables]
    except SmarigError:
        return  # any other exception fails the test
    assert all(m.ndim == 2 and not np.isinf(m).any() for m in matrices)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("[mat]", '[mat]\nfiles = ["B.mat"]'), r"mat.*'B.mat' is not a file name with one '\*'"),
        (("[mat]", '[mat]\nfiles = ["../*.mat"]'), r"not a file name"),
        (("[mat]", '[mat]\nloops = "diagonal"'), "mat.loops"),
        (("[mat]", '[mat]\n[file]\ndelimiter = "tab"'), r"\[mat\] describes no text"),
        (("[mat]", '[mat]\nloops = "rows"\n[time]\ncolumn = "t"'), "leave out"),
    ],
)
def test_an_invalid_mat_table_is_refused_naming_its_key(mapped, change, said):
    with pytest.raises(ConfigError, match=said):
        mapped(matlab(H=H, B=B), MAPPING.replace(*change))


def test_format_and_mapping_must_agree(write, imported):
    path, text = write(matlab(H=H, B=B), "data.mat"), MAPPING.replace("[mat]", "")
    with pytest.raises(UsageError, match="--map"):
        imported(path, "mat")
    with pytest.raises(UsageError, match="Use --format csv"):
        imported(path, "mat", mapping=str(write(text, "map.toml")))
    with pytest.raises(UsageError, match="Use --format mat"):
        imported(path, "csv", mapping=str(write(MAPPING, "map.toml")))


@given(arrays(np.float64, array_shapes(min_dims=2, max_dims=2), elements=st.floats(-1e30, 1e30)))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_matrix_scipy_writes_comes_back_bit_for_bit(tmp_path, matrix):
    for compressed in (False, True):
        path = tmp_path / "m.mat"
        path.write_bytes(matlab(compressed, a=matrix, b=matrix.astype(np.float32)))
        file = open_mat(path)
        np.testing.assert_array_equal(file.matrix("a"), matrix)
        np.testing.assert_array_equal(file.matrix("b"), matrix.astype(np.float32))


# --- the real ones ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("letter", ["B", "H"])
def test_the_ferrite_has_four_nested_loops_that_lag(shared_data, imported, letter):
    path = shared_data / "ferrite_nested" / f"{letter}_MnZn_HP_ferrite.mat"
    run = imported(path, "mat", mapping="ferrite_nested")
    assert run["step"].tolist() == [0] * 129 + [1] * 129 + [2] * 129 + [3] * 129
    h, b = run["input"].reshape(4, 129), run["position"].reshape(4, 129)
    np.testing.assert_allclose(h.max(axis=1), [5.98, 9.5, 20.07, 79.95], rtol=1e-3)
    assert (run.input_unit, run.unit) == ("A/m", "T")
    assert 0.39 < b.max() < 0.40  # near saturation of a Mn-Zn ferrite
    assert (h.argmin(axis=1) == 64).all()  # from the upper tip down, and back
    assert (np.diff(h[:, :65]) < 0).all()
    assert (np.diff(h[:, 64:]) > 0).all()
    assert (np.sum((h[:, 1:] + h[:, :-1]) / 2 * np.diff(b), axis=1) > 0).all()  # ∮H dB: losses, not gains
    assert run.meta["warnings"] == []
    assert run.meta["initial"] == "anhysteretic"


@pytest.mark.parametrize("letter", ["B", "H"])
def test_the_ferrite_is_read_as_scipy_reads_it(shared_data, letter):
    path, name = shared_data / "ferrite_nested" / f"{letter}_MnZn_HP_ferrite.mat", f"{letter}measT"
    np.testing.assert_array_equal(open_mat(path).matrix(name), loadmat(path)[name])
