"""Assembles a page: one HTML file with navigation, banners, style sheet, drawings and a script.

The interactive library (Plotly) is stored once in a folder of pages and loaded when a reader explores a figure. A page
loads nothing from the network.
"""

import filecmp
import json
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from smarig.core import atomic_file
from smarig.report.components.figure import Figure
from smarig.report.components.glossary import Term, glossary, terms_in
from smarig.report.components.html import Html, escaped, joined, tag
from smarig.report.components.page_summary import PageSummary
from smarig.report.components.style import CSS, template

LIBRARY = "smarig-figures.js"  # Plotly's script, beside the pages of a folder
_EXPLORED = 'class="explored"'  # marks the data of a figure that can be explored
GENERATOR = "smarig"
SIMULATED_TEXT = "every number on this page comes from a software simulation. No wire was measured."


@dataclass(frozen=True)
class Section:
    """A section of a page; ``short`` is its name in the navigation. A ``folded`` one opens on request."""

    title: str
    short: str
    parts: Sequence[Html | Figure]
    folded: bool = False


def page(
    title: str,
    lead: Any,
    sections: Sequence[Section],
    *,
    label: str = "",
    simulated: str = SIMULATED_TEXT,
    notices: Sequence[Html] = (),
    library: str = LIBRARY,
    summary: PageSummary | None = None,
) -> str:
    """The page as HTML. ``notices`` (for example of incomplete runs) precede all sections.

    ``label`` and ``simulated`` form the banner of simulated data. ``library`` is the address of the interactive
    library, relative to the page. ``summary`` tells an index what the page shows.
    """
    words = f"{label}: {simulated}" if label else ""
    banner = tag("aside", words, class_="twinbar", aria_label="Simulated, not measured") if label else ""
    skip = tag("a", "Skip to the content", href="#section-1", class_="skip")
    links = [tag("a", s.short, href=f"#section-{k}") for k, s in enumerate(sections, start=1) if s.short]
    body = tag("main", *(_section(k, s) for k, s in enumerate(sections, start=1)))
    used = terms_in(joined((title, lead, *notices, body)))
    if used:
        links.append(tag("a", "Glossary", href="#glossary"))
    top = tag("div", banner, tag("nav", skip, *links, aria_label="Sections"), class_="sticky")
    header = tag("header", tag("h1", title), tag("p", lead, class_="lead"), *notices, class_="top")
    script = Html(f"<script>{_FOLD_SCRIPT}{figure_script() if '<svg' in body else ''}</script>")
    whole = tag(
        "body",
        top,
        header,
        body,
        _glossary(used),
        _footer(words, library if _EXPLORED in body else ""),
        script,
        data_library=library,
    )
    head = _head(f"{label} · {title}" if label else title, summary)
    return f'<!DOCTYPE html>\n<html lang="en">{head}\n{whole}</html>\n'


def _head(title: str, summary: PageSummary | None) -> Html:
    return tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", name_="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name_="generator", content=GENERATOR),
        tag("title", title),
        summary.head() if summary else "",
        tag("style", Html(CSS)),
    )


def _section(number: int, section: Section) -> Html:
    parts = [part.html() if isinstance(part, Figure) else escaped(part) for part in section.parts]
    heading = tag("h2", section.title) if section.title else ""
    if section.folded:
        return tag("section", tag("details", tag("summary", heading), *parts), id=f"section-{number}")
    return tag("section", heading, *parts, id=f"section-{number}", class_="" if heading else "first")


def _glossary(used: Sequence[Term]) -> Html:
    """The meanings of the terms on the page, folded; the script links the terms in the text to them."""
    if not used:
        return Html("")
    folded = tag("details", tag("summary", tag("h2", "Glossary")), glossary(used))
    return tag("aside", folded, id="glossary", aria_label="Glossary")


def _footer(words: str, library: str) -> Html:
    library_note = (
        f' "Explore" needs the file {library}, which was written with this page.' if library else ""
    )
    footer_text = (
        f"Written by smarig {version('smarig')}. This file is self-contained and loads nothing from the network."
        f"{library_note}"
    )
    return tag("footer", tag("p", f"{words} {footer_text}".strip()))


def write_page(html: str, path: str | Path, force: bool = False) -> Path:
    """Write a page atomically, and the interactive library if the page expects it beside itself.

    Raises the errors of ``atomic_file``.
    """
    file = Path(path)
    with atomic_file(file, force=force) as part:
        part.write_text(html, encoding="utf-8")
    if _EXPLORED in html and f'data-library="{LIBRARY}"' in html:
        write_library(file.parent)
    return file


def write_library(folder: Path) -> Path:
    """Copy Plotly's script into a folder of pages if it is missing or of another version."""
    file, script = folder / LIBRARY, library_script()
    if not file.is_file() or not filecmp.cmp(script, file, shallow=False):
        with atomic_file(file, force=True) as part:
            shutil.copyfile(script, part)
    return file


def library_script() -> Path:
    """The script in the installed package, which is not imported: it takes thirty megabytes."""
    package = find_spec("plotly")
    if package is None or package.origin is None:
        raise ImportError("plotly is not installed")
    return Path(package.origin).parent / "package_data" / "plotly.min.js"


def is_smarig_page(path: Path) -> bool:
    """Whether a file is a page written by smarig, which may be overwritten without --force."""
    if not path.is_file():
        return False
    with path.open(encoding="utf-8", errors="replace") as file:
        return f'name="generator" content="{GENERATOR}"' in file.read(600)


# A link to a folded section, or to a place in it, opens it. The first use of a term in a section is such a link.
_FOLD_SCRIPT = """
(function(){ function open(){ const at=location.hash&&document.querySelector(location.hash),
  fold=at&&(at.querySelector(':scope>details')||at.closest('details'));
  if(fold){ fold.open=true; at.scrollIntoView(); } }
 addEventListener('hashchange',open); addEventListener('click',e=>{
  const link=e.target.closest&&e.target.closest('a[href="'+location.hash+'"]'); if(link) setTimeout(open); });
 const terms={}; document.querySelectorAll('#glossary dt').forEach(dt=>dt.dataset.written.split('|')
  .forEach(form=>terms[form]=dt));
 const forms=Object.keys(terms).sort((a,b)=>b.length-a.length);
 if(forms.length){ const any=new RegExp('(?<![\\\\w-])('+forms.join('|')+')s?(?![\\\\w-])','i');
  document.querySelectorAll('main section,header .notice').forEach(part=>{ const seen=new Set();
   part.querySelectorAll('p,li,figcaption,caption,small').forEach(block=>{
    const walk=document.createTreeWalker(block,NodeFilter.SHOW_TEXT), nodes=[];
    while(walk.nextNode()) nodes.push(walk.currentNode);
    nodes.forEach(node=>{ if(node.parentNode.closest('a,button,code,svg,label')) return;
     for(let found;(found=any.exec(node.data));){ const dt=terms[found[1].toLowerCase()];
      const rest=node.splitText(found.index+found[0].length);
      if(!seen.has(dt)){ seen.add(dt); const word=node.splitText(found.index), link=document.createElement('a');
       link.href='#'+dt.id; link.className='term'; link.title=dt.nextElementSibling.textContent;
       word.replaceWith(link); link.append(word); }
      node=rest; } }); }); }); }
 open(); })();
"""

_DRAW_SCRIPT = """
(function(){
 const template=TEMPLATE, config={displaylogo:false,responsive:true,displayModeBar:false};
 const library=document.body.dataset.library; let loading=null;
 function load(){ return loading=loading||new Promise((done,fail)=>{ const script=document.createElement('script');
  script.src=library; script.onload=done; script.onerror=()=>{ loading=null; fail(); };
  document.body.append(script); }); }
 async function unpacked(plot){ const text=plot.querySelector('script.explored').textContent;
  const bytes=Uint8Array.from(atob(text),c=>c.charCodeAt(0));
  const stream=new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return JSON.parse(await new Response(stream).text()); }
 function button(words,act){ const made=document.createElement('button');
  made.type='button'; made.textContent=words; made.onclick=()=>act(made); return made; }
 async function explore(plot,pressed){
  const old=plot.parentNode.querySelector('.live');
  if(old){ Plotly.purge(old); plot.parentNode.querySelector('.choices')?.remove(); old.remove();
   plot.style.display=''; pressed.textContent='Explore'; return; }
  try{ await load(); }catch{ pressed.textContent='The file '+library+' is missing beside this page.';
   pressed.disabled=true; return; }
  const spec=await unpacked(plot), live=document.createElement('div'), narrow=plot.clientWidth<520;
  live.className='live'; spec.layout.template=template; spec.layout.autosize=true;
  const menu=(spec.layout.updatemenus||[])[0]; delete spec.layout.updatemenus;
  if(narrow){ spec.layout.margin=Object.assign({l:52,r:8,t:40,b:46},spec.layout.narrow||{});
   spec.layout.font={size:11}; }
  plot.style.display='none'; plot.after(live); Plotly.newPlot(live,spec.data,spec.layout,config);
  if(menu) choices(live,menu);
  pressed.textContent='Drawing';
 }
 function choices(live,menu){
  const bar=document.createElement('div'); bar.className='choices'; bar.role='group';
  bar.setAttribute('aria-label','What is shown');
  menu.buttons.forEach((one,k)=>{ const choice=button(one.label,()=>{
    [...bar.children].forEach(b=>b.setAttribute('aria-pressed',b===choice)); Plotly[one.method](live,...one.args); });
   choice.setAttribute('aria-pressed',k===(menu.active||0)); bar.append(choice); });
  live.before(bar);
 }
 function save(plot){ const copy=plot.querySelector('svg').cloneNode(true);
  copy.removeAttribute('aria-hidden'); copy.setAttribute('font-family','Arial, Helvetica, sans-serif');
  const link=document.createElement('a'), n=[...document.querySelectorAll('.plot')].indexOf(plot)+1;
  link.href=URL.createObjectURL(new Blob([copy.outerHTML],{type:'image/svg+xml'}));
  link.download='figure-'+n+'.svg'; link.click(); }
 document.querySelectorAll('.plot').forEach(plot=>{ const tools=document.createElement('div'); tools.className='tools';
  if(plot.querySelector('script.explored')) tools.append(button('Explore',pressed=>explore(plot,pressed)));
  tools.append(button('SVG',()=>save(plot))); plot.after(tools); });
})();
"""


def figure_script() -> str:
    """The script of figures: saving a drawing, and exploring it with the interactive library."""
    return _DRAW_SCRIPT.replace("TEMPLATE", json.dumps(template()))
