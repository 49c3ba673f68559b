"""A model as FMU: FMI 2.0 for co-simulation in C, with sources, compiled for this machine if it has a C compiler."""

import hashlib
import platform
import shutil
import subprocess
import tempfile
import zipfile
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from xml.sax.saxutils import quoteattr

from smarig.core import StorageError
from smarig.exchange.c_code.c_source import CSource, c_source
from smarig.replay import Model

_PLATFORMS = {
    ("Linux", "x86_64"): ("linux64", ".so"),
    ("Darwin", "x86_64"): ("darwin64", ".dylib"),
    ("Darwin", "arm64"): ("darwin64", ".dylib"),
}
_FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-ffp-contract=off", "-fvisibility=hidden")
_COMPILER_TIMEOUT_S = 60


@dataclass(frozen=True)
class WrittenFmu:
    """What an FMU holds: the ``platform`` it was compiled for, "" for sources only."""

    platform: str


def write_fmu(model: Model, path: Path, name: str) -> WrittenFmu:
    """Write the FMU of a classical model. Raises the errors of ``c_source``; StorageError if compiling fails."""
    source = c_source(model, name)
    guid = _guid(source)
    glue = (files("smarig.exchange.c_code") / "fmi2.c").read_text(encoding="ascii").replace("MODEL", name)
    sources = {
        f"{name}.h": source.header,
        f"{name}.c": source.source,
        "fmi2.c": f'#define FMU_GUID "{guid}"\n{glue}',
    }
    kind, ending = _PLATFORMS.get((platform.system(), platform.machine()), ("", ""))
    compiler = (shutil.which("cc") or shutil.which("gcc")) if kind else None
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", _description(model, name, guid))
        for file, text in sources.items():
            archive.writestr(f"sources/{file}", text)
        if compiler:
            archive.writestr(
                f"binaries/{kind}/{name}{ending}", _compiled(compiler, sources, f"{name}{ending}")
            )
    return WrittenFmu(kind if compiler else "")


def _guid(source: CSource) -> str:
    """The identity of the model in braces, from its source."""
    digest = hashlib.sha256((source.header + source.source).encode()).hexdigest()
    parts = (digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32])
    return "{" + "-".join(parts) + "}"


def _compiled(compiler: str, sources: dict[str, str], target: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        for file, text in sources.items():
            (place / file).write_text(text, encoding="ascii")
        units = [file for file in sources if file.endswith(".c")]
        command = [compiler, *_FLAGS, *units, "-o", target, "-lm"]
        try:
            done = subprocess.run(
                command, cwd=place, capture_output=True, text=True, timeout=_COMPILER_TIMEOUT_S, check=False
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            raise StorageError(f"The C compiler {compiler} did not run: {error}.") from None
        if done.returncode:
            raise StorageError(f"The C compiler {compiler} failed: {done.stderr.strip().splitlines()[-1:]}.")
        return (place / target).read_bytes()


def _description(model: Model, name: str, guid: str) -> str:
    """modelDescription.xml with one input, one output, and the start as a parameter."""
    units = sorted({model.input.unit or "1", model.unit or "1"})
    declared = "".join(f"<Unit name={quoteattr(unit)}/>" for unit in units)
    made = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    h = model.hysteresis

    def variable(index: int, label: str, more: str, words: str, real: str) -> str:
        return (
            f"<ScalarVariable name={quoteattr(label)} valueReference={quoteattr(str(index))} "
            f"description={quoteattr(words)} {more}><Real {real}/></ScalarVariable>"
        )

    unit_in, unit_out = quoteattr(model.input.unit or "1"), quoteattr(model.unit or "1")
    variables = "".join(
        [
            variable(
                0,
                "input",
                'causality="input" variability="continuous"',
                model.input.quantity or "input",
                f'unit={unit_in} start="{h.lower!r}"',
            ),
            variable(
                1,
                "output",
                'causality="output" variability="continuous" initial="calculated"',
                model.output.quantity or "output",
                f"unit={unit_out}",
            ),
            variable(
                2,
                "start_positive",
                'causality="parameter" variability="fixed" initial="exact"',
                "0: from negative saturation; 1: from positive saturation",
                'start="0"',
            ),
        ]
    )
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName={quoteattr(model.name)} guid="{guid}"
 description="Preisach hysteresis, identified by smarig" generationTool="smarig {version("smarig")}"
 generationDateAndTime="{made}" variableNamingConvention="flat" numberOfEventIndicators="0">
<CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true"
 canGetAndSetFMUstate="true" canSerializeFMUstate="true" canNotUseMemoryManagementFunctions="true">
<SourceFiles><File name="{name}.c"/><File name="fmi2.c"/></SourceFiles></CoSimulation>
<UnitDefinitions>{declared}</UnitDefinitions>
<ModelVariables>{variables}</ModelVariables>
<ModelStructure><Outputs><Unknown index="2" dependencies="1"/></Outputs>
<InitialUnknowns><Unknown index="2" dependencies="1 3"/></InitialUnknowns></ModelStructure>
</fmiModelDescription>
"""
