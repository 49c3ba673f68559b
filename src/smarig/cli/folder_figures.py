"""The figures of all pages of a folder, each page in a folder of its own."""

from contextlib import AbstractContextManager
from pathlib import Path

from smarig.cli.output import show_message
from smarig.core import SmarigError, counted


def save_folder_figures(folder: Path, figures: Path, force: bool) -> int:
    """Save the figures of a folder's runs, and of its characterisation and diagnosis, below ``figures``; their number.

    The folders are named after the pages. A run that cannot be read is named and left out.
    """
    from smarig.app import is_characterisation
    from smarig.record import load_run
    from smarig.report import figures_saved_in, page_path, run_files, run_page

    def place(page: Path) -> AbstractContextManager[list[Path]]:
        return figures_saved_in(figures / page.relative_to(folder).with_suffix(""), force)

    saved = 0
    if is_characterisation(folder):
        saved += _characterisation_figures(folder, figures, force)
    files = run_files(folder)
    for file in counted(files, len(files)):
        try:
            run = load_run(file)
        except SmarigError as error:
            show_message(f"Not read: {error}")
            continue
        with place(page_path(file)) as written:
            run_page(run)
        saved += len(written)
    return saved


def _characterisation_figures(folder: Path, figures: Path, force: bool) -> int:
    from smarig.app import characterised_folder
    from smarig.report import characterisation_page, diagnosis_page, figures_saved_in

    evidence = characterised_folder(folder, show_message)
    with figures_saved_in(figures / "characterisation", force) as saved:
        characterisation_page(evidence)
    if evidence.diagnosis is None:
        return len(saved)
    with figures_saved_in(figures / "diagnosis", force) as of_diagnosis:
        diagnosis_page(evidence.diagnosis)
    return len(saved) + len(of_diagnosis)
