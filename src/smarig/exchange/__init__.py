"""Import of data files into runs, and export of runs to other formats."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.exchange.binary.text_archive import is_text_archive as is_text_archive
    from smarig.exchange.binary.text_archive import unpack_texts as unpack_texts
    from smarig.exchange.checks.drift import DriftDecision as DriftDecision
    from smarig.exchange.checks.drift import ForcCurves as ForcCurves
    from smarig.exchange.checks.drift import correct_drift_if_it_helps as correct_drift_if_it_helps
    from smarig.exchange.checks.drift import drift_corrected as drift_corrected
    from smarig.exchange.checks.value_bounds import plausible as plausible
    from smarig.exchange.checks.wrapped_counts import continued_counts as continued_counts
    from smarig.exchange.exporting import export_model as export_model
    from smarig.exchange.exporting import export_run as export_run
    from smarig.exchange.find_tables import find_tables as find_tables
    from smarig.exchange.importing import ImportReport as ImportReport
    from smarig.exchange.importing import import_file as import_file
    from smarig.exchange.layouts.logged_rows import logged_rows as logged_rows
    from smarig.exchange.mappings.mapping import CONDITION_UNITS as CONDITION_UNITS
    from smarig.exchange.mappings.mapping import MappingFile as MappingFile
    from smarig.exchange.mappings.mapping import load_mapping as load_mapping
    from smarig.exchange.tables.forc_file import read_forc as read_forc
    from smarig.exchange.tables.found_table import FoundColumn as FoundColumn
    from smarig.exchange.tables.found_table import FoundTable as FoundTable
    from smarig.exchange.tables.labelled_blocks import LabelledBlock as LabelledBlock
    from smarig.exchange.tables.labelled_blocks import labelled_blocks as labelled_blocks
    from smarig.exchange.tables.plane_table import PlaneTable as PlaneTable
    from smarig.exchange.tables.plane_table import plane_table as plane_table
    from smarig.exchange.tables.preamble import preamble_lines as preamble_lines
    from smarig.exchange.unchanged_file import FileChangedError as FileChangedError
    from smarig.exchange.unchanged_file import unchanged as unchanged
    from smarig.exchange.units.unit_conversion import convert as convert
    from smarig.exchange.units.unit_conversion import dimension as dimension
    from smarig.exchange.units.written_units import known_unit as known_unit
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
