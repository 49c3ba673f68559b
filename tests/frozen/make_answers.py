"""Stores the present answers of smarig, so that renaming and moving code can be shown to change nothing.

It computes answers to some hundred questions that use only stable interfaces: the command line, its JSON,
run and model files, and the names of ``import smarig``. Every answer has a name and can be computed alone:

    make_answers.py -o answers.json.xz                     # all but the slowest; with --all these, too
    make_answers.py --only 'box/0*' -o some.json.xz
    make_answers.py --compare                              # with the stored ones; 1 if anything differs
    make_answers.py --compare --only 'box/07/*' --exact    # to the last bit: on one machine only

See README.md in this folder.
"""

import argparse
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import pinned_kernels  # noqa: F401  before anything that imports numpy
from frozen.answers import KEPT, SLOW, Questions, load, save, wanted
from frozen.asking import Answer
from frozen.comparing import differences


def computed(globs: list[str], everything: bool) -> Iterator[tuple[str, Answer | Exception]]:
    """Name and answer (or what went wrong) of each question, one after the other; the time each took on stderr."""
    with tempfile.TemporaryDirectory() as folder:
        questions = Questions(Path(folder))
        for name in wanted(questions.names, globs, everything):
            before = time.process_time()
            try:
                answer = questions.answer(name)
            except Exception as error:
                answer = error
            print(f"{name}: {time.process_time() - before:.1f} s", file=sys.stderr, flush=True)
            yield name, answer


def make(out: Path, globs: list[str], everything: bool, add: bool) -> int:
    """Compute and write; ``add`` keeps what else the file holds."""
    answers = load(out) if add and out.is_file() else {}
    try:
        for name, answer in computed(globs, everything):
            if isinstance(answer, Exception):
                raise answer
            answers[name] = answer
    finally:  # what is computed is kept
        save(answers, out)
    print(f"{len(answers)} answers, {out.stat().st_size} bytes: {out}")
    return 0


def compare(kept: Path, globs: list[str], everything: bool, exact: bool) -> int:
    """Compute again and print every difference; 1 where there is one."""
    before, asked, found = load(kept), set(), 0
    names = wanted(before, globs, everything)
    for name, answer in computed(names, everything) if names else ():
        asked.add(name)
        for line in _lines(name, before[name], answer, exact):
            found += 1
            print(line, flush=True)
    left = [name for name in names if name not in asked]
    print(f"{len(asked)} answers compared, {found} differences; {len(left)} cannot be asked here {left[:3]}")
    return int(found > 0 or not asked)


def _lines(name: str, before: Answer, answer: Answer | Exception, exact: bool) -> Iterable[str]:
    """What to say of one answer."""
    if isinstance(answer, Exception):
        return [f"{name}: {type(answer).__name__}: {answer}"]
    return differences(before, answer, name, exact=exact)


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--only", action="append", default=[], metavar="GLOB", help="names; may be repeated")
    parser.add_argument("--all", action="store_true", help=f"also {', '.join(SLOW)}")
    parser.add_argument("-o", "--out", type=Path, help="write the answers here")
    parser.add_argument("--add", action="store_true", help="keep what else that file holds")
    parser.add_argument("--compare", action="store_true", help="compare with answers kept")
    parser.add_argument("--with", dest="kept", type=Path, default=KEPT, help="the answers kept")
    parser.add_argument("--exact", action="store_true", help="compare to the last bit")
    given = parser.parse_args()
    if given.compare == (given.out is not None):
        parser.error("give -o FILE or --compare")
    if given.compare:
        return compare(given.kept, given.only, given.all, given.exact)
    return make(given.out, given.only, given.all, given.add)


if __name__ == "__main__":
    sys.exit(main())
