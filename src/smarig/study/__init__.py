"""From data files of any origin to a page: columns understood, models identified, judged and diagnosed."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.study.data_files import find_files as find_files
    from smarig.study.each_file import FileOutcome as FileOutcome
    from smarig.study.each_file import studies_json as studies_json
    from smarig.study.each_file import study_each as study_each
    from smarig.study.field_loops import field_sentences as field_sentences
    from smarig.study.mapping_draft import mapping_draft as mapping_draft
    from smarig.study.next_step import next_step as next_step
    from smarig.study.study import study as study
    from smarig.study.study_files import STUDY_JSON as STUDY_JSON
    from smarig.study.study_files import STUDY_PAGE as STUDY_PAGE
    from smarig.study.study_files import VERDICT_LEVELS as VERDICT_LEVELS
    from smarig.study.study_options import SPLITS as SPLITS
    from smarig.study.study_options import Split as Split
    from smarig.study.study_options import StudyOptions as StudyOptions
    from smarig.study.study_result import POOR as POOR
    from smarig.study.study_result import StudyResult as StudyResult
    from smarig.study.table_guess import TableGuess as TableGuess
    from smarig.study.table_guess import guess_table as guess_table
    from smarig.study.understanding import understand as understand
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
