"""A study of each of many files: in parallel, continued where it was interrupted, and compared on one page."""

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from smarig.core import SmarigError, StorageError, UsageError, atomic_file, file_bytes
from smarig.exchange import FileChangedError
from smarig.report import LIBRARY, write_library
from smarig.study.data_files import NOT_DATA, find_files
from smarig.study.other_zeros import other_zeros
from smarig.study.parallel import completed
from smarig.study.studies_page import studies_page
from smarig.study.study import plain, study
from smarig.study.study_files import STUDY_JSON, STUDY_PAGE, outcome_word
from smarig.study.study_options import StudyOptions, study_key
from smarig.study.temperatures_over_rates import RateTrend, over_rates
from smarig.study.unpacked_files import with_unpacked


@dataclass(frozen=True)
class FileOutcome:
    """What became of one file: its folder, the JSON object of its study, or the reason of its failure.

    ``left_out``: why the file was not tried. ``reused``: an earlier result with equal file and options was kept.
    ``other_zero`` says how its zero differs from that of another file with the same loop, "" if it does not;
    ``over_rates`` is how its temperatures and those of the files like it go with the rate, None if they do not.
    """

    file: str
    folder: str
    found: dict[str, Any] | None = None
    failure: str = ""
    left_out: str = ""
    reused: bool = False
    other_zero: str = ""
    over_rates: RateTrend | None = None

    @property
    def failed(self) -> bool:
        """Whether the file was tried and could not be studied."""
        return self.found is None and not self.left_out


def study_each(
    places: Sequence[Path],
    out: Path,
    options: StudyOptions,
    *,
    workers: int,
    scheduler: str | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> list[FileOutcome]:
    """Study each file on its own in ``out``/NAME and write a page that compares them.

    ``workers`` processes, or the workers of the Dask ``scheduler`` at an address. A file that fails is listed with its
    reason. Earlier results of equal files and options are kept. Files of a folder that are no data (notes, programs)
    come last, with the reason why they were left out.
    """
    found = find_files(places)
    files = with_unpacked(found.data, out)
    out.mkdir(parents=True, exist_ok=True)
    write_library(out)
    tasks = [(str(file), str(out / name), options) for file, name in zip(files, _folders(files, places))]
    outcomes: dict[str, FileOutcome] = {}
    waiting = []
    for task in tasks:
        kept = _earlier(*task)
        if kept is None:
            waiting.append(task)
        else:
            outcomes[task[0]] = kept
    if outcomes:
        progress(f"{len(outcomes)} of {len(tasks)} files were studied before")
    try:
        with closing(completed(study_one, waiting, workers, scheduler)) as answers:
            for done, outcome in enumerate(answers, start=len(outcomes) + 1):
                outcomes[outcome.file] = outcome
                progress(f"{done} of {len(tasks)}: {outcome.file} {_short(outcome)}")
    except KeyboardInterrupt:
        progress(f"{len(outcomes)} of {len(tasks)} files are done and kept; the same command continues.")
        raise
    ordered = [outcomes[task[0]] for task in tasks]
    zeros, rates = other_zeros(ordered), over_rates(ordered)
    ordered = [replace(o, other_zero=zeros.get(o.file, ""), over_rates=rates.get(o.file)) for o in ordered]
    ordered += [FileOutcome(str(file), "", left_out=NOT_DATA) for file in found.left_out]
    _write(out / STUDY_PAGE, studies_page(ordered, out.name))
    _write(out / STUDY_JSON, json.dumps(plain(studies_json(ordered, out)), indent=1, ensure_ascii=False))
    return ordered


def study_one(task: tuple[str, str, StudyOptions]) -> FileOutcome:
    """The study of one file, in this or another process. Raises StorageError, because a full disk ends all others."""
    file, folder, options = task
    try:
        result = study([file], folder, options, library=f"../{LIBRARY}")
        return FileOutcome(file, folder, plain(result.to_json()))
    except StorageError:
        raise
    except FileChangedError as error:  # not kept: it says nothing of the file
        return FileOutcome(file, folder, None, str(error))
    except SmarigError as error:
        return _failed(task, str(error))
    except Exception as error:  # one bad file must not end the others
        return _failed(task, f"internal error ({type(error).__name__}: {error})")


def studies_json(outcomes: Sequence[FileOutcome], out: Path) -> dict[str, Any]:
    """The JSON object of the command line for many files."""
    return {
        "out": str(out),
        "page": str(out / STUDY_PAGE),
        "studied": sum(o.found is not None for o in outcomes),
        "failed": {o.file: o.failure for o in outcomes if o.failed},
        "left_out": {o.file: o.left_out for o in outcomes if o.left_out},
        "other_zeros": {o.file: o.other_zero for o in outcomes if o.other_zero},
        "over_rates": {o.file: o.over_rates.sentence() for o in outcomes if o.over_rates},
        "reused": sum(o.reused for o in outcomes),
        "studies": [o.found for o in outcomes if o.found is not None],
    }


def _failed(task: tuple[str, str, StudyOptions], reason: str) -> FileOutcome:
    """A failure, which is kept so that it is not tried again for nothing."""
    file, folder, options = task
    try:
        record = {"key": study_key([Path(file)], options), "failure": reason}
    except UsageError as error:  # it was removed, or replaced by a pipe: there is nothing to recognise it by
        return FileOutcome(file, folder, None, str(error))
    except OSError as error:
        return FileOutcome(file, folder, None, f"{file} cannot be read: {error.strerror or error}.")
    Path(folder).mkdir(parents=True, exist_ok=True)
    _write(Path(folder) / STUDY_JSON, json.dumps(record, ensure_ascii=False))
    return FileOutcome(file, folder, None, reason)


def _earlier(file: str, folder: str, options: StudyOptions) -> FileOutcome | None:
    """An earlier outcome of an equal file and options."""
    path = Path(folder) / STUDY_JSON
    try:
        record = json.loads(file_bytes(path))
        if record["key"] != study_key([Path(file)], options):
            return None
    except (SmarigError, OSError, ValueError, KeyError, TypeError):
        return None
    if failure := record.get("failure"):
        return FileOutcome(file, folder, None, str(failure), reused=True)
    return FileOutcome(file, folder, record, reused=True) if (Path(folder) / STUDY_PAGE).is_file() else None


def _folders(files: Sequence[Path], places: Sequence[Path]) -> Iterator[str]:
    """A folder name for each file: its path below the folder that was given, in one name."""
    taken: set[str] = set()
    for file in files:
        above = next((p for p in places if p.is_dir() and p in file.parents), file.parent)
        name = "_".join(file.relative_to(above).parts).replace(" ", "_")
        unique, number = name, 2
        while unique in taken:
            unique, number = f"{name}_{number}", number + 1
        taken.add(unique)
        yield unique


def _short(outcome: FileOutcome) -> str:
    if outcome.found is None:
        return f"failed: {outcome.failure[:200]}"
    return outcome_word(outcome.found)


def _write(path: Path, text: str) -> None:
    with atomic_file(path, force=True) as part:
        part.write_text(text, encoding="utf-8")
