"""Assembles a page: one HTML file with navigation, banners, style sheet and scripts.

Plotly's script is embedded once per page, or stored once in a folder of pages. A page loads nothing from the network.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plotly.offline import get_plotlyjs

from smarig.core import atomic_file
from smarig.report.components.figure import Figure
from smarig.report.components.html import Html, escaped, joined, tag
from smarig.report.components.style import CSS, template

LIBRARY = "smarig-figures.js"  # Plotly's script, shared by the pages of a folder
GENERATOR = "smarig"
SIMULATED_TEXT = "every number on this page comes from a software simulation. No wire was measured."


@dataclass(frozen=True)
class Section:
    """A section of a page; ``short`` is its name in the navigation."""

    title: str
    short: str
    parts: Sequence[Html | Figure]


def page(
    title: str,
    lead: Any,
    sections: Sequence[Section],
    *,
    label: str = "",
    simulated: str = SIMULATED_TEXT,
    notices: Sequence[Html] = (),
    library: str = "",
) -> str:
    """The page as HTML. ``notices`` (for example of incomplete runs) precede all sections.

    ``label`` and ``simulated`` form the banner of simulated data. ``library`` is the address of Plotly's script in
    the same folder, "" to embed it.
    """
    words = f"{label}: {simulated}" if label else ""
    banner = tag("aside", words, class_="twinbar", aria_label="Simulated, not measured") if label else ""
    skip = tag("a", "Skip to the content", href="#section-1", class_="skip")
    links = [tag("a", s.short, href=f"#section-{k}") for k, s in enumerate(sections, start=1)]
    top = tag("div", banner, tag("nav", skip, *links, aria_label="Sections"), class_="sticky")
    header = tag("header", tag("h1", title), tag("p", lead, class_="lead"), *notices, class_="top")
    body = tag("main", *(_section(k, s) for k, s in enumerate(sections, start=1)))
    drawn = 'class="plot' in body
    scripts = _scripts(library) if drawn else Html("")
    whole = tag(
        "body", top, header, body, _footer(words, library if drawn else ""), scripts, data_library=library
    )
    head = _head(f"{label} · {title}" if label else title)
    return f'<!DOCTYPE html>\n<html lang="en">{head}\n{whole}</html>\n'


def _head(title: str) -> Html:
    return tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", name_="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name_="generator", content=GENERATOR),
        tag("title", title),
        tag("style", Html(CSS)),
    )


def _section(number: int, section: Section) -> Html:
    parts = [part.html() if isinstance(part, Figure) else escaped(part) for part in section.parts]
    return tag("section", tag("h2", section.title), *parts, id=f"section-{number}")


def _scripts(library: str) -> Html:
    missing = tag("noscript", tag("p", "The figures on this page need JavaScript; the tables do not."))
    plotly = tag("script", src=library) if library else Html(f"<script>{get_plotlyjs()}</script>")
    return joined([missing, plotly, Html(f"\n<script>{figure_script()}</script>")])


def _footer(words: str, library: str) -> Html:
    alone = (
        f"Its figures need the file {library}, which was written with it"
        if library
        else "This file is self-contained"
    )
    footer_text = f"Written by smarig. {alone}; the page loads nothing from the network."
    return tag("footer", tag("p", f"{words} {footer_text}".strip()))


def write_page(html: str, path: str | Path, force: bool = False) -> Path:
    """Write a page atomically; raises the errors of ``atomic_file``."""
    file = Path(path)
    with atomic_file(file, force=force) as part:
        part.write_text(html, encoding="utf-8")
    return file


def write_library(folder: Path) -> Path:
    """Write Plotly's script into a folder of pages if it is missing or of another version."""
    file, text = folder / LIBRARY, get_plotlyjs()
    if not file.is_file() or file.read_text(encoding="utf-8") != text:
        with atomic_file(file, force=True) as part:
            part.write_text(text, encoding="utf-8")
    return file


def is_smarig_page(path: Path) -> bool:
    """Whether a file is a page written by smarig, which may be overwritten without --force."""
    if not path.is_file():
        return False
    with path.open(encoding="utf-8", errors="replace") as file:
        return f'name="generator" content="{GENERATOR}"' in file.read(600)


_DRAW_SCRIPT = """
(function(){
 const template=TEMPLATE, config={displaylogo:false,responsive:true,displayModeBar:false};
 const plots=[...document.querySelectorAll('.plot')];
 if(!window.Plotly){ plots.forEach(div=>div.textContent=
  'This figure needs the file '+document.body.dataset.library+', which was written with this page.'); return; }
 let next=0;
 function draw(div){
  const source=div.querySelector('script'); if(!source) return;
  const spec=JSON.parse(source.textContent); source.remove();
  spec.layout.template=template; spec.layout.autosize=true;
  const menu=(spec.layout.updatemenus||[])[0]; delete spec.layout.updatemenus;
  if(div.clientWidth<520){ spec.layout.margin=Object.assign({l:52,r:8,t:40,b:46},spec.layout.narrow||{});
   spec.layout.font={size:11}; }
  Plotly.newPlot(div,spec.data,spec.layout,config);
  if(menu) choices(div,menu);
 }
 function choices(div,menu){
  const bar=document.createElement('div'); bar.className='choices'; bar.role='group';
  bar.setAttribute('aria-label','What is shown');
  menu.buttons.forEach((one,k)=>{ const button=document.createElement('button');
   button.type='button'; button.textContent=one.label; button.setAttribute('aria-pressed',k===(menu.active||0));
   button.onclick=()=>{ [...bar.children].forEach(b=>b.setAttribute('aria-pressed',b===button));
    Plotly[one.method](div,...one.args); };
   bar.append(button); });
  div.before(bar);
 }
 function step(){ if(next<plots.length){ draw(plots[next++]); setTimeout(step,0); } }
 function all(){ while(next<plots.length) draw(plots[next++]); }
 function fit(size){ plots.forEach(div=>Plotly.relayout(div,
  {width:div.clientWidth,height:div.clientHeight,'font.size':size})); }
 addEventListener('beforeprint',()=>{ all(); document.querySelectorAll('details').forEach(d=>d.open=true);
  document.body.classList.add('printing'); fit(10); });
 addEventListener('afterprint',()=>{ document.body.classList.remove('printing');
  plots.forEach(div=>Plotly.relayout(div,{width:null,height:null,autosize:true,
   'font.size':div.clientWidth<520?11:13})); });
 step();
})();
"""


def figure_script() -> str:
    """The drawing script, with the template of all figures."""
    return _DRAW_SCRIPT.replace("TEMPLATE", json.dumps(template()))
