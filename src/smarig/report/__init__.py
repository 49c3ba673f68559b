"""HTML pages that need no network. Each page is one file here; their sections and figures are in the folders."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.report.certificate.certificate_page import Further as Further
    from smarig.report.certificate.certificate_page import certificate_page as certificate_page
    from smarig.report.certificate.certificate_page import certificate_units as certificate_units
    from smarig.report.certificate.certificate_page import certified_model as certified_model
    from smarig.report.characterisation_page import characterisation_page as characterisation_page
    from smarig.report.closed_loop.closed_loop_text import loop_result_text as loop_result_text
    from smarig.report.closed_loop.loop_result import closed_loop_result as closed_loop_result
    from smarig.report.closed_loop.loop_result import is_closed_loop as is_closed_loop
    from smarig.report.components import style as style
    from smarig.report.components.comparison_labels import distinct_names as distinct_names
    from smarig.report.components.decimate import path as path
    from smarig.report.components.figure import Figure as Figure
    from smarig.report.components.figure import Panel as Panel
    from smarig.report.components.figure import axis as axis
    from smarig.report.components.figure import dots as dots
    from smarig.report.components.figure import error_bars as error_bars
    from smarig.report.components.figure import figure_with_text as figure_with_text
    from smarig.report.components.figure import line as line
    from smarig.report.components.html import Html as Html
    from smarig.report.components.html import bullets as bullets
    from smarig.report.components.html import cards as cards
    from smarig.report.components.html import notice as notice
    from smarig.report.components.html import paragraph as paragraph
    from smarig.report.components.html import table as table
    from smarig.report.components.html import tag as tag
    from smarig.report.components.html import with_subscripts as with_subscripts
    from smarig.report.components.numbers import duration as duration
    from smarig.report.components.numbers import interval_text as interval_text
    from smarig.report.components.numbers import number as number
    from smarig.report.components.numbers import signed as signed
    from smarig.report.components.numbers import to_uncertainty as to_uncertainty
    from smarig.report.components.page import LIBRARY as LIBRARY
    from smarig.report.components.page import Section as Section
    from smarig.report.components.page import is_smarig_page as is_smarig_page
    from smarig.report.components.page import library_script as library_script
    from smarig.report.components.page import page as page
    from smarig.report.components.page import write_library as write_library
    from smarig.report.components.page import write_page as write_page
    from smarig.report.components.page_summary import found_page as found_page
    from smarig.report.components.run_description import display_unit as display_unit
    from smarig.report.components.run_description import input_title as input_title
    from smarig.report.components.run_description import output_title as output_title
    from smarig.report.components.run_description import source_label as source_label
    from smarig.report.components.thumbnail import thumbnail as thumbnail
    from smarig.report.diagnosis.verdict_text import SEVERITY_LEVELS as SEVERITY_LEVELS
    from smarig.report.diagnosis_page import diagnosis_page as diagnosis_page
    from smarig.report.drawing import figures_saved_in as figures_saved_in
    from smarig.report.folder_contents import model_name as model_name
    from smarig.report.folder_contents import model_summary as model_summary
    from smarig.report.folder_contents import runs_of_folders as runs_of_folders
    from smarig.report.folder_report import INDEX_FILE as INDEX_FILE
    from smarig.report.folder_report import page_path as page_path
    from smarig.report.folder_report import report_folder as report_folder
    from smarig.report.folder_report import run_files as run_files
    from smarig.report.forc_page import forc_page as forc_page
    from smarig.report.material_page import material_page as material_page
    from smarig.report.measured_diagnosis_page import thermal_diagnosis_page as thermal_diagnosis_page
    from smarig.report.model_comparison_page import models_page as models_page
    from smarig.report.models.assessment import assessment as assessment
    from smarig.report.models.evidence import Evidence as Evidence
    from smarig.report.models.evidence import ExtensionEvidence as ExtensionEvidence
    from smarig.report.models.preisach_verdict import against_preisach as against_preisach
    from smarig.report.models.preisach_verdict import preisach_verdict as preisach_verdict
    from smarig.report.notebook import plot as plot
    from smarig.report.run_comparison_page import comparison_page as comparison_page
    from smarig.report.run_page import run_page as run_page
    from smarig.report.runs.derived_quantities import derived_quantities as derived_quantities
    from smarig.report.runs.run_assessment import run_assessment as run_assessment
    from smarig.report.runs.run_summary import RunSummary as RunSummary
    from smarig.report.runs.run_summary import summary_of as summary_of
    from smarig.report.runs.run_summary import summary_with_loop as summary_with_loop
    from smarig.report.runs.run_title import titled as titled
    from smarig.report.summary_page import characterisation_summary as characterisation_summary
    from smarig.report.summary_page import summary_page as summary_page
    from smarig.report.transformation.tangent_figures import stress_figure as stress_figure
    from smarig.report.transformation.tangent_figures import tangent_figure as tangent_figure
    from smarig.report.transformation.transformation_tables import branches_text as branches_text
    from smarig.report.transformation.transformation_tables import figure_name as figure_name
    from smarig.report.transformation.transformation_tables import figures_table as figures_table
    from smarig.report.transformation.transformation_tables import runs_table as runs_table
    from smarig.report.transformation.transformation_tables import stress_table as stress_table
    from smarig.report.transformation_page import transformation_page as transformation_page
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
