"""The glossary of a page: the terms the page uses, reached by a click and by keys, without a network."""

import re

import pytest

from report.browser import Browser, axe, chromium
from smarig.report.components.glossary import terms, terms_in
from smarig.report.components.html import paragraph
from smarig.report.components.page import Section, page


def names(text):
    return [term.name for term in terms_in(str(paragraph(text)))]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("the noise floor of settled points", ["noise floor", "settled point"]),
        ("Held-out points", ["held-out data"]),
        ("the FORC density, and a density", ["density", "FORC density"]),
        ("smarig", []),
        ("one_wire_twin", []),
        ("nothing of the kind", []),
        ("A_s = 60 °C", ["transformation temperatures"]),
    ],
)
def test_terms_are_found_as_words(text, expected):
    assert names(text) == expected


def test_subscripts_in_markup_are_read_and_scripts_are_not():
    assert [t.name for t in terms_in("<p>A<sub>s</sub></p><script>relay</script>")] == [
        "transformation temperatures"
    ]


def test_every_form_and_every_anchor_belongs_to_one_term():
    anchors = [term.anchor for term in terms()]
    assert len(set(anchors)) == len(anchors) > 100
    forms = [form for term in terms() for form in term.written]
    assert len(set(forms)) == len(forms)
    assert all(re.fullmatch(r"term-[\w-]+", anchor) for anchor in anchors)


def test_a_page_holds_the_meanings_of_its_terms_and_no_others():
    html = page("Title", "Lead", [Section("One", "One", [paragraph("The noise floor of a relay.")])])
    assert re.findall(r'<dt id="([^"]+)"', html) == ["term-noise-floor", "term-relay"]
    assert "The standard deviation of a settled output that was repeated in one state" in html
    assert "γ<sub>αβ</sub>" in html
    assert 'href="#glossary"' in html


def test_a_page_without_terms_has_no_glossary():
    assert 'href="#glossary"' not in page(
        "Title", "Lead", [Section("One", "One", [paragraph("Nothing here.")])]
    )


@pytest.fixture(scope="module")
def tab(tmp_path_factory):
    pytest.importorskip("websocket", reason="websocket-client is not installed (pip install smarig[test])")
    chromium()
    folder = tmp_path_factory.mktemp("glossary")
    text = paragraph("smarig compares the noise floor with the noise floor of relays.")
    (folder / "page.html").write_text(
        page("Title", "Lead", [Section("One", "One", [text])]), encoding="utf-8"
    )
    browser = Browser(folder / "profile")
    yield browser.open(folder / "page.html")
    browser.close()


def test_the_first_use_of_a_term_links_to_its_meaning(tab):
    links = "[...document.querySelectorAll('a.term')].map(a => [a.innerText, a.title])"
    shown = dict(tab.run(links))
    assert list(shown) == ["noise floor", "relays"]
    assert shown["noise floor"].startswith("The standard deviation of a settled output")
    assert tab.run("document.querySelector('main p').innerText").startswith("smarig compares the noise floor")


@pytest.mark.long("takes a second")
def test_keys_open_it_and_axe_finds_nothing(tab):
    axe()
    assert tab.run("document.querySelector('#glossary details').open") is False
    for _ in range(2):  # again after the reader has closed it
        tab.run("document.querySelector('#glossary details').open = false")
        tab.run("document.querySelector('a.term').focus()")
        tab.key("Enter", 13)
        tab.run("new Promise(done => setTimeout(done, 100))")
        assert tab.run("document.querySelector('#glossary details').open") is True
        assert tab.run("document.querySelector('dt:target').innerText") == "noise floor"
    assert tab.violations() == []
    assert tab.complaints() == []
