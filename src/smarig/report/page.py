"""The page kit: one self-contained HTML file with navigation, banners and everything it needs inside.

Plotly's script is embedded once; nothing is ever loaded from anywhere. Knows no physics.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plotly.offline import get_plotlyjs

from smarig.report.figure import Figure
from smarig.report.html import Html, escaped, joined, tag
from smarig.report.style import CSS, template
from smarig.whole_file import whole_file

_DRAW = """
(function(){
 const template=TEMPLATE, config={displaylogo:false,responsive:true,displayModeBar:false};
 const plots=[...document.querySelectorAll('.plot')];
 let next=0;
 function draw(div){
  const source=div.querySelector('script'); if(!source) return;
  const spec=JSON.parse(source.textContent); source.remove();
  spec.layout.template=template; spec.layout.autosize=true;
  if(div.clientWidth<520){ spec.layout.margin=Object.assign({l:52,r:8,t:40,b:46},spec.layout.narrow||{});
   spec.layout.font={size:11}; }
  Plotly.newPlot(div,spec.data,spec.layout,config);
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


@dataclass(frozen=True)
class Section:
    """A titled part of the page; ``short`` is its name in the navigation."""

    title: str
    short: str
    parts: Sequence[Html | Figure]


def page(
    title: str, lead: Any, sections: Sequence[Section], *, label: str = "", notices: Sequence[Html] = ()
) -> str:
    """The whole page as text. ``notices`` stand above everything else (incomplete runs, refusals)."""
    banner = tag("div", f"{label}: {_SIMULATED}", class_="twinbar", role="note") if label else ""
    links = [tag("a", s.short, href=f"#section-{k}") for k, s in enumerate(sections, start=1)]
    top = tag("div", banner, tag("nav", *links, aria_label="Sections"), class_="sticky")
    header = tag("header", tag("h1", title), tag("p", lead, class_="lead"), *notices, class_="top")
    body = tag("main", *(_section(k, s) for k, s in enumerate(sections, start=1)), _footer(label))
    head = joined(
        [
            tag("meta", charset="utf-8"),
            tag("meta", name_="viewport", content="width=device-width, initial-scale=1"),
            tag("title", f"{label} · {title}" if label else title),
            tag("style", Html(CSS)),
        ]
    )
    scripts = _scripts() if 'class="plot' in body else Html("")
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head>\n<body>{top}{header}{body}{scripts}</body></html>\n'


_SIMULATED = "every number on this page comes from a software simulation. No wire was measured."


def _section(number: int, section: Section) -> Html:
    parts = [part.html() if isinstance(part, Figure) else escaped(part) for part in section.parts]
    return tag("section", tag("h2", section.title), *parts, id=f"section-{number}")


def _scripts() -> Html:
    draw = _DRAW.replace("TEMPLATE", json.dumps(template()))
    missing = tag("noscript", tag("p", "The figures of this page need JavaScript; the tables do not."))
    return joined([missing, Html(f"<script>{get_plotlyjs()}</script>\n<script>{draw}</script>")])


def _footer(label: str) -> Html:
    words = "Written by smarig. This file is complete in itself and loads nothing from anywhere."
    return tag("footer", (f"{label}: {_SIMULATED} " if label else "") + words)


def write_page(html: str, path: str | Path, force: bool = False) -> Path:
    """Write a page, all of it or nothing; errors as of ``whole_file``."""
    file = Path(path)
    with whole_file(file, force=force) as part:
        part.write_text(html, encoding="utf-8")
    return file
