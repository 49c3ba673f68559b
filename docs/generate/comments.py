"""What stands in the comment after a key or a name: the text that people read beside the code.

    tick_s: float  # of the device

Knows Python's syntax; refuses to know what is documented.
"""

import ast
import inspect
from types import ModuleType

from smarig.config import comments_by_line


def tuple_comments(module: ModuleType, name: str) -> dict[str, str]:
    """Comments after the texts of a tuple that a module assigns to ``name``."""
    source = inspect.getsource(module)
    comments = comments_by_line(source)
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple) and _names(node) == [name]:
            texts = (e for e in node.value.elts if isinstance(e, ast.Constant))
            return {str(e.value): comments.get(e.lineno, "") for e in texts}
    raise LookupError(f"{module.__name__} has no tuple {name}")


def _names(node: ast.Assign) -> list[str]:
    return [t.id for t in node.targets if isinstance(t, ast.Name)]
