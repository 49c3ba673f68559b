"""A folder that came along holds links where the console writes: nothing is written through them, nor read."""

import re
from pathlib import Path

import pytest

import smarig
from console.web.test_led_out import Pages, pages_of
from smarig.console.web.console_context import is_own_place
from smarig.console.web.evaluations import PAGES
from smarig.console.web.pages.data_file_page import STUDIES, UPLOADS

ROWS = "t,u,y\n" + "".join(f"{k},{abs(50 - k % 100)},{abs(50 - k % 100) ** 1.1}\n" for k in range(300))
PART = '--x\r\nContent-Disposition: form-data; name="file"; filename="a.csv"\r\n\r\n' + ROWS + "\r\n--x--\r\n"
KEY = "0123456789ab"


@pytest.fixture
def folder(tmp_path) -> Path:
    (tmp_path / "outside").mkdir()
    found = tmp_path / "folder"
    found.mkdir()
    return found


def linked(folder: Path, place: str) -> None:
    """A link at a place of the folder to the folder outside, which has a folder for whatever is written."""
    (folder / place).parent.mkdir(parents=True, exist_ok=True)
    (folder / place).symlink_to(folder.parent / "outside", target_is_directory=True)


def uploaded(pages: Pages):
    return pages.send("/study", PART.encode(), "multipart/form-data; boundary=x")


def untouched(folder: Path) -> bool:
    return not list((folder.parent / "outside").iterdir())


@pytest.mark.parametrize("name", [UPLOADS, STUDIES, f"{STUDIES}/a_{KEY}", f"{UPLOADS}/{KEY}"])
def test_nothing_is_written_through_a_link(folder, name):
    linked(folder, name)
    if not name.startswith(UPLOADS):
        (folder / UPLOADS / KEY).mkdir(parents=True)
        (folder / UPLOADS / KEY / "a.csv").write_text(ROWS)
    with pages_of(folder) as pages:
        reply = uploaded(pages) if name == UPLOADS else pages.ask(f"/study/{KEY}", input="u", output="y")
        assert reply.status == 422
        assert re.search(rf"{name}.* is a link, or lies behind one. Remove the link", reply.body)
        assert pages.ask(f"/study/{KEY}").status == 422
    assert untouched(folder)


@pytest.fixture
def entries(folder, monkeypatch) -> list[str]:
    """The identities of two runs of the folder."""
    monkeypatch.setenv("SMARIG_RUNNING_DIR", str(folder.parent / "running"))
    for name in ("a", "b"):
        smarig.run("validation", rig="one_wire_twin", out=folder / f"{name}.run.sqlite", points=2)
    with pages_of(folder) as pages:
        pages.library.refresh()
        return [entry.id for entry in pages.library.search(kind="run").entries]


def test_no_page_of_an_evaluation_is_written_through_a_link(folder, entries):
    linked(folder, PAGES)
    with pages_of(folder) as pages:
        report = pages.ask(f"/library/{entries[0]}/evaluate", job="report")
        compared = pages.send("/library/compare", "&".join(f"id={id}" for id in entries).encode())
        assert [report.status, compared.status] == [422, 422]
        assert f"{PAGES}/" in report.body
        assert "is a link, or lies behind one. Remove the link" in report.body
    assert untouched(folder)


def test_a_link_is_no_finished_page(folder, entries):
    secret = folder.parent / "secret.html"
    secret.write_text("secret")
    (folder / PAGES).mkdir()
    with pages_of(folder) as pages:
        for entry in pages.library.search(kind="run").entries:
            (folder / PAGES / f"{entry.identity}.html").symlink_to(secret)
            reply = pages.ask(f"/library/{entry.id}/page")
            assert "secret" not in reply.body
    assert secret.read_text() == "secret"


def test_places_of_the_folder_without_links_are_its_own(folder):
    (folder / "here").symlink_to(folder / "there")
    (folder / "round").symlink_to("round")
    assert is_own_place(folder / "there" / "new" / "file", folder)
    assert not any(is_own_place(folder / name / "file", folder) for name in ("here", "round", ".."))
    other_name = folder.parent / "name"
    other_name.symlink_to(folder)
    assert is_own_place(other_name / "file", other_name), "the folder itself may be reached by a link"
