"""What stands in the comment after a key or a name: the text that people read beside the code.

    tick_s: float  # of the device

Knows Python's syntax; refuses to know what is documented.
"""

import ast
import inspect
import io
import textwrap
import tokenize
from types import ModuleType


def class_comments(cls: type) -> dict[str, str]:
    """Comments after the annotated names of a class and of those it inherits from."""
    found: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        if base.__module__.startswith(cls.__module__.partition(".")[0]):
            found |= _annotated(inspect.getsource(base))
    return found


def tuple_comments(module: ModuleType, name: str) -> dict[str, str]:
    """Comments after the texts of a tuple that a module assigns to ``name``."""
    source = inspect.getsource(module)
    comments = _comments(source)
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple) and _names(node) == [name]:
            texts = (e for e in node.value.elts if isinstance(e, ast.Constant))
            return {str(e.value): comments.get(e.lineno, "") for e in texts}
    raise LookupError(f"{module.__name__} has no tuple {name}")


def _names(node: ast.Assign) -> list[str]:
    return [t.id for t in node.targets if isinstance(t, ast.Name)]


def _annotated(source: str) -> dict[str, str]:
    source = textwrap.dedent(source)
    comments = _comments(source)
    (body,) = (node.body for node in ast.parse(source).body if isinstance(node, ast.ClassDef))
    return {
        node.target.id: comments.get(node.end_lineno or 0, "")
        for node in body
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    }


def _comments(source: str) -> dict[int, str]:
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return {t.start[0]: t.string.lstrip("# ") for t in tokens if t.type == tokenize.COMMENT}
