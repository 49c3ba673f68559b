"""Reads a TOML file into a frozen, checked value. Each error is one sentence that names its key."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, TypeVar, get_args

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, ValidationInfo

from smarig.core.catalogue import suggestion
from smarig.core.errors import ConfigError, UsageError
from smarig.core.file_content import TOML
from smarig.core.gate import Named, named
from smarig.core.gated_keys import Origin
from smarig.core.regular_file import check_file
from smarig.core.shown_text import has_control_characters, shown
from smarig.core.swapped_file import swapped_file
from smarig.core.toml_kind import swapped_table
from smarig.core.toml_text import NotToml, parsed_toml

LARGEST_BYTES = 10_000_000
_MOST_PROBLEMS = 20  # listed in one message
_LONGEST_KEY, _LONGEST_TEXT = 100, 1000  # in a message

Number = Annotated[
    float, Field(strict=True, allow_inf_nan=False)
]  # "1.0", true and inf are errors, not numbers


class TomlTable(BaseModel):
    """A frozen table of a configuration file; unknown keys are errors. ``file_kind``: of the schema of a whole file."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    file_kind: ClassVar[str] = ""


@dataclass(frozen=True)
class Source:
    """A file whose keys are checked: the context of a schema, so that its texts are marked (``marked_as``)."""

    where: str
    origin: Origin

    def mark(self, text: str, key: str) -> Named:
        """A text of the file, marked."""
        return named(text, key, self.where, self.origin)


def marked_as(key: str) -> AfterValidator:
    """For the annotation of a key of a schema: its text is marked where the ``context`` of validation is a ``Source``.

    Values given in Python have no such context, and count as the user's. A text with control characters is refused.
    """

    def mark(text: str, info: ValidationInfo) -> str:
        refuse_control_characters(text)
        source = info.context
        return source.mark(text, key) if text and isinstance(source, Source) else text

    return AfterValidator(mark)


def refuse_control_characters(text: str) -> str:
    """A text that leads to a path, a program or an address. ValueError if it cannot."""
    if has_control_characters(text):
        raise ValueError("a path, program or address has no control characters")
    return text


def refuse_null_characters(value: Any) -> Any:
    """A value of any type. ValueError for a text that neither a path nor the command of an instrument can hold."""
    if isinstance(value, dict | list | tuple):
        for inner in value.values() if isinstance(value, dict) else value:
            refuse_null_characters(inner)
    elif isinstance(value, str) and "\0" in value:
        raise ValueError("a text has no null character")
    return value


SchemaType = TypeVar("SchemaType", bound=BaseModel)


def load_toml(schema: type[SchemaType], path: Path) -> SchemaType:
    """Read a TOML file and check it against a schema. ConfigError names file, key and expected value."""
    return check_table(schema, read_toml(path), str(path))


def read_toml(path: Path) -> dict[str, Any]:
    """A TOML file as a dictionary. A syntax error raises ConfigError with its line. The mark of an
    editor at its beginning (BOM) is no part of it.
    """
    check_file(path)
    try:
        if path.stat().st_size > LARGEST_BYTES:
            raise ConfigError(
                f"{path} is larger than {LARGEST_BYTES // 10**6} MB, too large for a TOML file."
            )
        return parsed_toml(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}.") from None
    except UnicodeDecodeError as error:
        raise ConfigError(swapped_file(path, TOML) or f"{path} is not valid TOML: {error}.") from None
    except NotToml as error:
        raise ConfigError(swapped_file(path, TOML) or f"{path} {error}.") from None


def check_table(
    schema: type[SchemaType],
    data: Any,
    where: str,
    origin: Origin = Origin.FILE,
    source: Source | None = None,
) -> SchemaType:
    """Check data against a schema. One ConfigError lists every problem, or says that it is a file of another kind.

    What it names is marked for the gate: by ``source``, or else as that of a file that the user named.
    """
    try:
        return schema.model_validate(data, context=source or Source(where, origin))
    except ValidationError as error:
        if swapped := _swapped(schema, data, where):
            raise ConfigError(swapped) from None
        problems = _first_causes(error.errors(include_url=False))
        sentences = [f"{where}: {_sentence(e, schema)}" for e in problems[:_MOST_PROBLEMS]]
        if len(problems) > _MOST_PROBLEMS:
            sentences.append(f"{where}: {len(problems) - _MOST_PROBLEMS} more problems are not listed.")
        raise ConfigError("\n".join(sentences)) from None


def _first_causes(problems: list[Any]) -> list[Any]:
    """The problems without those of a list that is too short only because of what is wrong with its items."""
    around = {problem["loc"][:k] for problem in problems for k in range(len(problem["loc"]))}
    return [p for p in problems if p["type"] != "too_short" or p["loc"] not in around]


def _swapped(schema: type[BaseModel], data: Any, where: str) -> str:
    """A sentence on a file of another kind, "" for all others."""
    kind = schema.file_kind if issubclass(schema, TomlTable) else ""
    if not kind or not isinstance(data, dict):
        return ""
    required = [key for key, field in schema.model_fields.items() if field.is_required()]
    return swapped_table(data, kind, where, required)


def problem_text(error: Any) -> str:
    """What is wrong with a value, in words: of an error of pydantic, which speaks of tuples and items."""
    for kind, bound, words in (
        ("too_short", "min_length", "at least"),
        ("too_long", "max_length", "at most"),
    ):
        if error["type"] == kind:
            count = error["ctx"][bound]
            return f"it must have {words} {count} {'entry' if count == 1 else 'entries'}"
    return error["msg"].removeprefix("Value error, ")


def _sentence(error: Any, schema: type[BaseModel]) -> str:
    key = ".".join(f"{part!s:.{_LONGEST_KEY}}" for part in error["loc"]) or "file"
    if error["type"] == "extra_forbidden":
        last = f"{error['loc'][-1]!s:.{_LONGEST_KEY}}"
        return f"unknown key '{key}'{suggestion(last, _keys(schema, error['loc'][:-1]))}"
    if error["type"] == "missing":
        return f"key '{key}' is missing."
    message = f"{problem_text(error):.{_LONGEST_TEXT}}"
    value_text = "" if isinstance(error["input"], dict) else f" (given: {shown(error['input'])})"
    return f"{key}: {message}{value_text}."


def _keys(schema: type[BaseModel], path: tuple) -> list[str]:
    for part in path:
        if isinstance(part, int):
            continue
        fields = schema.model_fields.get(str(part))
        inner = fields.annotation if fields else None
        inner = next((a for a in get_args(inner) if isinstance(a, type)), inner)
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            return sorted(schema.model_fields)
        schema = inner
    return sorted(schema.model_fields)
