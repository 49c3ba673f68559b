"""The elements of a MATLAB 5 file: kind and payload of each, and the flags, size and name of a variable."""

import struct
from dataclasses import dataclass

INT8, INT32, MATRIX = 1, 5, 14  # kinds of elements: mi…
NUMERIC = {6: "double", 7: "single", 8: "int8", 9: "uint8", 10: "int16", 11: "uint16"}
NUMERIC |= {12: "int32", 13: "uint32", 14: "int64", 15: "uint64"}
_OTHER = {1: "cell", 2: "struct", 3: "object", 4: "char", 5: "sparse", 16: "function", 17: "opaque"}
_COMPLEX, _LOGICAL = 0x800, 0x200
_TEXTS = {INT8: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}


@dataclass(frozen=True)
class Variable:
    """One variable of the file: size, MATLAB class, and the bytes of its elements."""

    shape: tuple[int, ...]
    kind: str
    order: str
    elements: memoryview


def size_of(view: memoryview, order: str) -> int:
    return struct.unpack_from(order + "I", view, 4)[0]


def element(view: memoryview, order: str) -> tuple[int, memoryview, memoryview]:
    """Kind and payload of the first element, and the rest; ValueError if it is cut off.

    An element of at most four bytes is inside its own tag, with its size above its kind.
    """
    (kind,) = struct.unpack_from(order + "I", view)
    if kind >> 16:
        start, size, kind, following = 4, kind >> 16, kind & 0xFFFF, 8
        if size > 4:
            raise ValueError("too large for its tag")
    else:
        start, size = 8, size_of(view, order)
        following = start + -(-size // 8) * 8
    if start + size > len(view):
        raise ValueError("cut off")
    return kind, view[start : start + size], view[following:]


def variable_of(data: memoryview, order: str) -> tuple[str, Variable]:
    """Name and description of a variable: flags, size and name come first; objects of newer MATLABs have no size."""
    _, flags, rest = element(data, order)
    (word,) = struct.unpack_from(order + "I", flags)
    code = word & 0xFF
    kind = NUMERIC[code] if code in NUMERIC else _OTHER[code]
    if word & _LOGICAL:
        kind = "logical"
    if word & _COMPLEX:
        kind = f"complex {kind}"
    what, size, rest = element(rest, order)
    if what == INT8:
        return bytes(size).decode("ascii"), Variable((), kind, order, rest)
    if what != INT32:
        raise ValueError("no size")
    shape = struct.unpack(f"{order}{len(size) // 4}i", size)
    what, name, rest = element(rest, order)
    if what != INT8 or min(shape, default=-1) < 0:
        raise ValueError("no name, or a negative size")
    return bytes(name).decode("ascii"), Variable(shape, kind, order, rest)


def text_of(variable: Variable) -> str:
    """The text of a row of characters; "" for any other variable."""
    if variable.kind != "char" or len(variable.shape) != 2 or min(variable.shape) != 1:
        return ""
    kind, payload, _ = element(variable.elements, variable.order)
    coding = _TEXTS.get(kind, "")
    if coding.startswith("utf-") and coding != "utf-8":
        coding += {"<": "-le", ">": "-be"}[variable.order]
    return bytes(payload).decode(coding, errors="replace").strip() if coding else ""
