"""Common foundations of all packages: samples, commands, errors, files and catalogues."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.core import file_content as file_content
    from smarig.core.atomic_file import atomic_file as atomic_file
    from smarig.core.atomic_file import check_replaceable as check_replaceable
    from smarig.core.atomic_file import check_writable as check_writable
    from smarig.core.catalogue import catalogue_entry as catalogue_entry
    from smarig.core.catalogue import catalogue_kind as catalogue_kind
    from smarig.core.catalogue import catalogue_names as catalogue_names
    from smarig.core.catalogue import catalogue_summary as catalogue_summary
    from smarig.core.catalogue import docstring_summary as docstring_summary
    from smarig.core.catalogue import is_path as is_path
    from smarig.core.catalogue import own_entries as own_entries
    from smarig.core.catalogue import own_file_error as own_file_error
    from smarig.core.catalogue import own_files as own_files
    from smarig.core.catalogue import resolve_name as resolve_name
    from smarig.core.catalogue import suggestion as suggestion
    from smarig.core.clause import capitalised as capitalised
    from smarig.core.command import Command as Command
    from smarig.core.command import Drive as Drive
    from smarig.core.command import Elapsed as Elapsed
    from smarig.core.command import Hold as Hold
    from smarig.core.command import Mark as Mark
    from smarig.core.command import Protocol as Protocol
    from smarig.core.command import Settled as Settled
    from smarig.core.command import StepResult as StepResult
    from smarig.core.command import StepVerdict as StepVerdict
    from smarig.core.command import Waveform as Waveform
    from smarig.core.command import Zero as Zero
    from smarig.core.errors import ConfigError as ConfigError
    from smarig.core.errors import DataError as DataError
    from smarig.core.errors import Interrupted as Interrupted
    from smarig.core.errors import InUse as InUse
    from smarig.core.errors import LeaseExpired as LeaseExpired
    from smarig.core.errors import LimitExceeded as LimitExceeded
    from smarig.core.errors import RigFault as RigFault
    from smarig.core.errors import SmarigError as SmarigError
    from smarig.core.errors import StorageError as StorageError
    from smarig.core.errors import UsageError as UsageError
    from smarig.core.file_content import MODEL as MODEL
    from smarig.core.file_content import PAGE as PAGE
    from smarig.core.file_content import RUN as RUN
    from smarig.core.file_content import TABLE as TABLE
    from smarig.core.file_content import TOML as TOML
    from smarig.core.file_content import content_kind as content_kind
    from smarig.core.formula import Formula as Formula
    from smarig.core.natural_order import natural_order as natural_order
    from smarig.core.natural_order import pattern_order as pattern_order
    from smarig.core.new_file import check_regular as check_regular
    from smarig.core.new_file import new_file as new_file
    from smarig.core.notebook_display import NotebookDisplay as NotebookDisplay
    from smarig.core.number_text import number_from_text as number_from_text
    from smarig.core.probability import chi2_quantile as chi2_quantile
    from smarig.core.probability import chi2_tail as chi2_tail
    from smarig.core.probability import f_quantile as f_quantile
    from smarig.core.probability import f_tail as f_tail
    from smarig.core.probability import normal_quantile as normal_quantile
    from smarig.core.probability import t_quantile as t_quantile
    from smarig.core.probability import t_tail as t_tail
    from smarig.core.process_lock import check_free as check_free
    from smarig.core.process_lock import process_lock as process_lock
    from smarig.core.profile_table import profile_numbers as profile_numbers
    from smarig.core.profile_table import profile_rows as profile_rows
    from smarig.core.progress_share import counted as counted
    from smarig.core.progress_share import share_done as share_done
    from smarig.core.resources import make_importable as make_importable
    from smarig.core.resources import shipped as shipped
    from smarig.core.sample import NAN as NAN
    from smarig.core.sample import Quality as Quality
    from smarig.core.sample import Sample as Sample
    from smarig.core.severity import Severity as Severity
    from smarig.core.severity import highest_severity as highest_severity
    from smarig.core.severity import severity_of as severity_of
    from smarig.core.shown_text import printable as printable
    from smarig.core.shown_text import shown as shown
    from smarig.core.stored_number import stored_number as stored_number
    from smarig.core.swapped_file import has_run_tables as has_run_tables
    from smarig.core.swapped_file import swapped_file as swapped_file
    from smarig.core.toml_file import Number as Number
    from smarig.core.toml_file import TomlTable as TomlTable
    from smarig.core.toml_file import check_table as check_table
    from smarig.core.toml_file import load_toml as load_toml
    from smarig.core.toml_file import read_toml as read_toml
    from smarig.core.unit_text import in_unit as in_unit
    from smarig.core.unit_text import spaced as spaced
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
