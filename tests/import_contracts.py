"""A contract for import-linter: only a package itself imports its modules; others import its public names."""

import importlib
from collections.abc import Mapping, Sequence
from typing import Any

import grimp
from importlinter import Contract, ContractCheck, fields, output


class ExportedNamesOnly(Contract):
    """Other packages import ``smarig.PACKAGE``, never ``smarig.PACKAGE.module``.

    ``container`` holds the packages; ``except_for`` lists modules that anybody may import.
    """

    container = fields.StringField()
    except_for = fields.SetField(subfield=fields.StringField(), required=False)

    def check(self, graph: grimp.ImportGraph, verbose: bool) -> ContractCheck:
        """Every import of a module inside a package by something outside it."""
        del verbose
        allowed = {str(module) for module in self.except_for or ()}
        broken = [
            {"importer": importer, "imported": module}
            for package in sorted(graph.find_children(str(self.container)))
            for module in sorted(graph.find_descendants(package) - allowed)
            for importer in sorted(graph.find_modules_that_directly_import(module))
            if importer != package
            and not importer.startswith(f"{package}.")
            and not _exported(package, module, graph.get_import_details(importer=importer, imported=module))
        ]
        return ContractCheck(kept=not broken, metadata={"broken": broken})

    def render_broken_contract(self, check: ContractCheck) -> None:
        """One line for each import that passes by the package."""
        for link in check.metadata["broken"]:
            output.print_error(f"{link['importer']} imports {link['imported']}", bold=False)


def _exported(package: str, module: str, details: Sequence[Mapping[str, Any]]) -> bool:
    """Whether the lines import a public name from the package: a function may have the name of its module."""
    return module.removeprefix(f"{package}.") in getattr(
        importlib.import_module(package), "__all__", ()
    ) and all(
        line["line_contents"].startswith(f"from {package} import") and ";" not in line["line_contents"]
        for line in details
    )
