"""The documentation builds without warnings, requests nothing from the internet, and has no broken links."""

import html.parser
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

ROOT = Path(__file__).resolve().parents[2]
LOADS = {"script", "link", "img", "iframe", "source", "video", "audio", "embed", "object", "use", "image"}
ABOUT = {"canonical", "prev", "next", "index", "search", "genindex"}  # of <link>: nothing is loaded
WRITTEN_BY_SPHINX = {"genindex.html", "search.html", "py-modindex.html"}


class PageContents(html.parser.HTMLParser):
    """What a page loads, where it links, its anchors and its headings."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.headings = 0
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Sort it."""
        attributes = {name: value or "" for name, value in attrs}
        self.anchors.add(attributes.get("id", ""))
        self.headings += tag == "h1"
        targets = [attributes[name] for name in ("src", "href", "data", "xlink:href") if name in attributes]
        if tag in LOADS and attributes.get("rel", "") not in ABOUT:
            self.loads += targets
        elif tag == "a":
            self.links += targets


@pytest.fixture
def site(tmp_path):
    """The site, built strictly from a copy of docs/."""
    pytest.importorskip("sphinx", reason="needs the extra docs")
    source, out = tmp_path / "docs", tmp_path / "site"
    ignored = shutil.ignore_patterns("generated", "__pycache__", "_build")
    shutil.copytree(ROOT / "docs", source, ignore=ignored)
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-j", "2", str(source), str(out)]
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(command, capture_output=True, encoding="utf-8", env=environment)
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return out


@pytest.mark.long("takes a minute")
def test_the_site(site):
    """One test, for it is built once."""
    pages = {path: PageContents(path) for path in sorted(site.rglob("*.html"))}
    sources = [p.relative_to(ROOT / "docs") for p in (ROOT / "docs").rglob("*.md")]
    written = {p.with_suffix("") for p in sources if "generated" not in p.parts}
    built = {path.relative_to(site).with_suffix("") for path in pages}
    assert written
    assert not written - built, "every page is built"
    wrong = [
        *_external_requests(site, pages),
        *_lost(site, pages),
        *_headless(pages),
        *_unreached(site, pages),
    ]
    assert not wrong, "\n".join(wrong)


def _external_requests(site, pages):
    """Whatever a page or a style would load from another machine."""
    for path, page in pages.items():
        yield from (f"{path.name} loads {u}" for u in page.loads if urlsplit(u).netloc)
    for path in site.rglob("*.css"):
        text = path.read_text(encoding="utf-8")
        for u in re.findall(r"(?:url\(|@import\s+)['\"]?((?:https?:)?//[^)'\"]+)", text):
            yield f"{path.name} loads {u}"


def _lost(site, pages):
    """Links and files that are not there."""
    for path, page in pages.items():
        for target in page.links + page.loads:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            there = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not there.exists():
                yield f"{path.relative_to(site)}: no {target}"
            elif parts.fragment and there in pages and unquote(parts.fragment) not in pages[there].anchors:
                yield f"{path.relative_to(site)}: no anchor {target}"


def _headless(pages):
    for path, page in pages.items():
        if page.headings != 1 and path.name not in WRITTEN_BY_SPHINX:
            yield f"{path.name} has {page.headings} titles"


def _unreached(site, pages):
    """Pages that no way leads to from the front page."""
    reached, ahead = set(), [site / "index.html"]
    while ahead:
        path = ahead.pop()
        if path in reached or path not in pages:
            continue
        reached.add(path)
        links = (urlsplit(u) for u in pages[path].links)
        ahead += [(path.parent / unquote(u.path)).resolve() for u in links if u.path and not u.netloc]
    for path in pages.keys() - reached:
        if path.name not in WRITTEN_BY_SPHINX:
            yield f"{path.relative_to(site)} is reached from nowhere"


HEADING = re.compile(r"^#{1,3} (.+)$", re.MULTILINE)
PAGE_LINK = re.compile(r"\]\(([^)\s]*[.#/][^)\s]*)\)")  # no formula
TOCTREE = re.compile(r"```\{toctree\}\n(.*?)```", re.DOTALL)


def _anchors(text):
    """Those of the headings, as MyST makes them."""
    return {re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-") for words in HEADING.findall(text)}


def _written():
    """The pages that people have written, with their texts."""
    pages = (ROOT / "docs").rglob("*.md")
    return {p: p.read_text(encoding="utf-8") for p in pages if "generated" not in p.parts}


def _wrong_links(texts):
    """Without a build: links to pages and headings that are not there; generated pages are left to Sphinx."""
    for path, text in texts.items():
        for target in PAGE_LINK.findall(text):
            parts = urlsplit(target)
            there = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if parts.scheme or "generated" in there.parts:
                continue
            if there not in texts and not there.exists():
                yield f"{path.name}: no {target}"
            elif parts.fragment and there in texts and parts.fragment not in _anchors(texts[there]):
                yield f"{path.name}: no heading {target}"


def test_links_between_pages_lead_to_pages_and_headings():
    texts = _written()
    assert not list(_wrong_links(texts))
    trees = [(path.parent, tree) for path, text in texts.items() for tree in TOCTREE.findall(text)]
    listed = {
        p
        for folder, tree in trees
        for entry in filter(None, tree.splitlines())
        for p in folder.glob(f"{entry}.md")
    }
    assert texts.keys() - listed == {ROOT / "docs" / "index.md"}, "every page is in a table of contents"


def test_a_wrong_link_between_pages_is_found(tmp_path):
    links = "[b](#a-title) [c](#c) [d](nothing.md) [e](https://elsewhere.org) γ[u](t)"
    assert list(_wrong_links({tmp_path / "a.md": f"# A title\n{links}"})) == [
        "a.md: no heading #c",
        "a.md: no nothing.md",
    ]


LINK = re.compile(r"\]\(([^)\s]+)\)")
OUTSIDE = ("README.md", "CHANGELOG.md", "firmware_protocol/README.md")


@pytest.mark.parametrize("name", OUTSIDE)
def test_links_from_outside_lead_somewhere(name):
    page = ROOT / name
    local = [u for u in LINK.findall(page.read_text(encoding="utf-8")) if not urlsplit(u).scheme]
    assert not [u for u in local if u[0] != "#" and not (page.parent / urlsplit(u).path).exists()]


def test_no_link_would_be_found_missing_only_by_luck(tmp_path):
    """The checks see what they are for."""
    (tmp_path / "index.html").write_text(
        '<h1 id="a">A</h1><a href="b.html#x">b</a><a href="c.html">c</a><img src="https://elsewhere/d.png">'
    )
    (tmp_path / "b.html").write_text("<p>no title</p>")
    (tmp_path / "alone.html").write_text("<h1>alone</h1>")
    pages = {path: PageContents(path) for path in sorted(tmp_path.rglob("*.html"))}
    assert list(_external_requests(tmp_path, pages)) == ["index.html loads https://elsewhere/d.png"]
    assert list(_lost(tmp_path, pages)) == ["index.html: no anchor b.html#x", "index.html: no c.html"]
    assert list(_headless(pages)) == ["b.html has 0 titles"]
    assert list(_unreached(tmp_path, pages)) == ["alone.html is reached from nowhere"]
