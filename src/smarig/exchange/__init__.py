"""Data in and out: files of others become runs, runs become files for others.

Knows formats, units and what is odd in a file. Refuses to know rigs at work, models and reports.
"""

from smarig.exchange.drift import DriftDecision, ForcCurves, correct_drift_if_it_helps, drift_corrected
from smarig.exchange.exporting import export_run
from smarig.exchange.forc_file import ForcFile, read_forc
from smarig.exchange.importing import ImportReport, import_file
from smarig.exchange.mapping import load_mapping

__all__ = [
    "DriftDecision",
    "ForcCurves",
    "ForcFile",
    "ImportReport",
    "correct_drift_if_it_helps",
    "drift_corrected",
    "export_run",
    "import_file",
    "load_mapping",
    "read_forc",
]
