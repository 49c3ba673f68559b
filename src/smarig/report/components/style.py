"""The style of all pages: palette, fonts, style sheet and plot template.

The colours are those of Okabe & Ito, which colour-blind readers can distinguish. Each has one meaning on all pages.
"""

from typing import Any

from smarig.preisach import surface_forms

INK, GREY, FAINT = "#1b1f24", "#6b7280", "#d9dde3"
HEATING, COOLING = "#D55E00", "#0072B2"  # vermilion: rising input, blue: falling input
CURRENT, TEMPERATURE, POSITION = "#E69F00", "#D55E00", "#0072B2"
FIRST, SECOND, GOOD, BAD = "#0072B2", "#D55E00", "#009E73", "#D55E00"
MODEL, EXTENDED, MEASURED = "#009E73", "#CC79A7", "#9aa3ad"  # measured paths lie below those of models
_OTHER_SURFACES = {"table": "#6b7280", "positive": "#009E73"}
# Compared items, in the order of the command line.
COMPARED = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#1b1f24", "#6b7280")
DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot", "solid", "dash")
SYMBOLS = (
    "circle",
    "square-open",
    "diamond-open",
    "triangle-up-open",
    "x",
    "cross",
    "star-open",
    "hexagon-open",
)
BAND = "rgba(107,114,128,.18)"  # of noise, of a tolerance, of an interval
SEQUENCE = "Cividis"
# Red positive, blue negative, white zero (after ColorBrewer RdBu).
DIVERGING = [
    [0.0, "#2166ac"],
    [0.25, "#67a9cf"],
    [0.42, "#d1e5f0"],
    [0.5, "#ffffff"],
    [0.58, "#fddbc7"],
    [0.75, "#ef8a62"],
    [1.0, "#b2182b"],
]
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"


def surface_colour(kind: str) -> str:
    """The colour of a kind of surface, the same on all pages; the ink colour for any other name."""
    form = surface_forms().get(kind)
    return form.colour if form else _OTHER_SURFACES.get(kind, INK)


def colours(n: int) -> list[str]:
    """n colours along cividis, dark to bright (without the brightest quarter, which is unreadable on white)."""
    stops = ((0, 34, 78), (60, 77, 110), (124, 123, 120), (187, 173, 108))
    picked = []
    for k in range(n):
        at = (len(stops) - 1) * k / max(n - 1, 1)
        i = min(int(at), len(stops) - 2)
        mixed = (round(a + (at - i) * (b - a)) for a, b in zip(stops[i], stops[i + 1]))
        picked.append("rgb({},{},{})".format(*mixed))
    return picked


def _axis() -> dict[str, Any]:
    return {
        "showline": True,
        "linecolor": INK,
        "linewidth": 1,
        "mirror": True,
        "ticks": "inside",
        "ticklen": 5,
        "gridcolor": "#eceff3",
        "zeroline": False,
        "automargin": True,
        "exponentformat": "power",
        "title": {"standoff": 8},
    }


def template() -> dict[str, Any]:
    """The Plotly template of all figures, embedded once per page."""
    scene_axis = {"backgroundcolor": "#f7f8fa", "gridcolor": FAINT, "showbackground": True, "zeroline": False}
    return {
        "layout": {
            "font": {"family": FONT, "size": 13, "color": INK},
            "paper_bgcolor": "#ffffff",
            "plot_bgcolor": "#ffffff",
            "margin": {"l": 64, "r": 16, "t": 40, "b": 52},
            "xaxis": _axis(),
            "yaxis": _axis(),
            "hovermode": "closest",
            "legend": {"orientation": "h", "x": 0, "y": 1.07, "yanchor": "bottom", "font": {"size": 12}},
            "scene": {"xaxis": scene_axis, "yaxis": scene_axis, "zaxis": scene_axis},
        }
    }


CSS = """
:root{color-scheme:light dark;--ink:#1b1f24;--grey:#5b6470;--line:#d9dde3;--soft:#f5f6f8;--blue:#0072B2;--amber:#f7c948;
 --ground:#fff;--text:#333a44;--link:#005a8f;--edge:#8b939e;--warm:#fff8e8;--rose:#fdf0e8;--mark:#fff0c2}
@media screen and (prefers-color-scheme:dark){:root{--ink:#e6e9ee;--grey:#a3acb8;--line:#3a424d;--soft:#1e242c;
 --blue:#6cb8ec;--ground:#12161b;--text:#c3cad4;--link:#6cb8ec;--edge:#59616c;--warm:#3a2f10;--rose:#3c1f12;--mark:#4a3d12}
 .plot,.gallery svg,td svg{background:#fff;color-scheme:only light;filter:invert(.92) hue-rotate(180deg)}
 button[aria-pressed=true]{color:#12161b}}
*{box-sizing:border-box}
html{scroll-padding-top:5.5rem;-webkit-text-size-adjust:100%}
body{margin:0;background:var(--ground);color:var(--ink);font:16px/1.55 FONT;counter-reset:section figure table;
 font-variant-numeric:tabular-nums}
main,header.top,footer{max-width:1180px;margin:0 auto;padding:0 24px}sub{line-height:0}
.sticky{position:sticky;top:0;z-index:20;background:var(--ground);border-bottom:1px solid var(--line)}
.twinbar{background:repeating-linear-gradient(-45deg,#f7c948 0 22px,#f2b632 22px 44px);color:#111;font-weight:700;
 text-align:center;padding:6px 12px;letter-spacing:.02em}
nav{display:flex;gap:2px 16px;overflow-x:auto;white-space:nowrap;padding:8px 24px;max-width:1180px;margin:0 auto;
 font-size:14px}
nav a{color:var(--grey);text-decoration:none}nav a:hover{color:var(--blue);text-decoration:underline}
h1{font-size:clamp(24px,3.4vw,36px);line-height:1.15;margin:28px 0 6px;letter-spacing:-.01em;overflow-wrap:anywhere}
.lead{color:var(--grey);margin:0 0 18px;font-size:17px;max-width:72ch;overflow-wrap:anywhere}
section{margin:44px 0;counter-increment:section}
h2{font-size:23px;margin:0 0 12px;padding-top:14px;border-top:2px solid var(--ink);line-height:1.25}
h2::before{content:counter(section) "  ";color:var(--grey);font-weight:400}
section.first{margin:0 0 36px;counter-increment:none}section>details>summary{list-style-position:outside}
section>details>summary h2{display:inline-block;width:calc(100% - 1.2em);vertical-align:top}
section>details:not([open])>summary h2{font-weight:500}
h3{font-size:17px;margin:26px 0 6px}
p,li{max-width:78ch;overflow-wrap:anywhere}
code{font:13px/1.4 ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;overflow-wrap:anywhere}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(185px,1fr));gap:12px;margin:18px 0}
.card{border:1px solid var(--line);border-top:4px solid var(--blue);padding:10px 14px 12px;background:var(--ground)}
.card small{display:block;color:var(--grey);font-size:13px}
.card strong{display:block;font-size:25px;line-height:1.25;font-weight:650;letter-spacing:-.01em}
.card span{display:block;font-size:13px;color:var(--grey);line-height:1.4}
.notice{border-left:5px solid var(--grey);background:var(--soft);padding:10px 16px;margin:12px 0;max-width:90ch;
 overflow-wrap:anywhere}
.notice p{margin:.2em 0}.notice.good{border-color:#009E73}.notice.warning{border-color:#E69F00;background:var(--warm)}
.notice.bad{border-color:#D55E00;background:var(--rose)}
figure{margin:22px 0 30px;counter-increment:figure;break-inside:avoid}
figure .panels{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,var(--least,560px)),1fr));gap:10px;
 overflow-x:auto}
.cell{min-width:0}.cell.wide{grid-column:1/-1}.plot{min-width:0;position:relative;max-width:760px}
.wide>.plot{max-width:none}.plot svg{display:block;width:100%;height:auto}.plot svg text{font-family:FONT}
.tools{display:flex;gap:10px;justify-content:flex-end;max-width:760px}.wide>.tools{max-width:none}
.tools button{border:0;padding:2px 4px;font-size:12px;color:var(--grey);background:none;text-decoration:underline}
.tools button:hover{color:var(--blue)}
@media (min-width:1000px){figure.single{display:grid;grid-template-columns:minmax(0,660px) minmax(240px,1fr);gap:0 28px;
 align-items:center}.pairs figure.single{display:block}
 .with-text{display:grid;grid-template-columns:minmax(0,660px) minmax(280px,1fr);gap:0 28px;align-items:start}
 .with-text figure.single{display:block;margin-top:12px}.with-text .table{margin:8px 0 10px}
 .with-text table{font-size:13px}.with-text td,.with-text th{padding-right:10px;white-space:nowrap}
 .with-text td:last-child{white-space:normal}
 .with-text ul{padding-left:18px;margin:8px 0;font-size:15px;line-height:1.45}}
.choices{display:flex;flex-wrap:wrap;gap:6px}
button,input,select{font:inherit;font-size:14px;color:var(--ink);background:var(--ground);border:1px solid var(--edge);
 border-radius:3px;padding:5px 10px}
button{cursor:pointer}button:hover{border-color:var(--blue)}
button[aria-pressed=true]{background:var(--blue);border-color:var(--blue);color:#fff}
:focus-visible{outline:3px solid var(--blue);outline-offset:2px}
.search{display:flex;flex-wrap:wrap;gap:10px 14px;align-items:end;margin:0 0 10px}
.search label{font-size:13px;color:var(--grey)}.search label>*{display:block;margin-top:2px}
.search label:first-child{flex:1 1 240px}.search label:first-child input{width:100%}
.gallery{list-style:none;margin:0;padding:0;display:grid;grid-template-columns:repeat(auto-fill,minmax(200px,1fr));gap:14px}
.runs td,.runs tbody th,.named{white-space:nowrap}.runs table{font-size:13px}.runs th,.runs td{padding-right:9px}
.gallery li{border:1px solid var(--line);padding:8px 10px 10px;max-width:none;min-width:0;break-inside:avoid}
.gallery li.level{border-left:4px solid var(--line)}.gallery li.good{border-left-color:var(--good,#009E73)}
.gallery li.warning{border-left-color:#E69F00}.gallery li.bad{border-left-color:#D55E00}
.gallery li.twinned{border-top:4px solid var(--amber)}.gallery svg,td svg{display:block;width:100%;height:auto}
.gallery a{font-weight:600;overflow-wrap:anywhere}
.gallery p{margin:2px 0 0;font-size:13px;line-height:1.4;color:var(--grey)}
a{color:var(--link)}th button{border:0;padding:0;font-weight:600;text-align:left}
th[aria-sort=ascending] button::after{content:" ▲"}th[aria-sort=descending] button::after{content:" ▼"}
.swatch{display:inline-block;width:22px;height:0;border-top:4px solid;vertical-align:middle;margin-right:8px}
.skip{position:absolute;left:-9999px}.skip:focus{position:static}
.pairs,.columns{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,480px),1fr));gap:0 28px;
 align-items:start}
.columns{grid-template-columns:repeat(auto-fit,minmax(min(100%,440px),1fr))}.columns td{white-space:nowrap}
figcaption{font-size:14px;line-height:1.5;color:var(--text);max-width:100ch;margin-top:4px;overflow-wrap:anywhere}
figcaption::before{content:"Figure " counter(figure) ". ";font-weight:700}
.twin{display:inline-block;background:var(--amber);color:#111;font-weight:700;font-size:12px;padding:0 6px;
 border-radius:2px;letter-spacing:.03em;white-space:nowrap}
.severity{padding:0 6px;border-radius:2px;white-space:nowrap}.severity.minor{background:var(--mark);color:var(--ink)}
.severity.major{background:var(--rose);color:var(--ink);font-weight:700;outline:1px solid #D55E00}
.severity.invalid{background:var(--ink);color:var(--ground);font-weight:700}
.table{overflow-x:auto;margin:16px 0 22px}
table{border-collapse:collapse;font-size:14px;line-height:1.4;min-width:min(100%,420px)}
caption{text-align:left;font-size:14px;color:var(--text);padding-bottom:6px;max-width:100ch}
caption::before{counter-increment:table;content:"Table " counter(table) ". ";font-weight:700}
th,td{text-align:left;padding:4px 16px 4px 0;border-bottom:1px solid var(--line);vertical-align:top;font-weight:400}
thead th{border-bottom:2px solid var(--ink);font-weight:600;vertical-align:bottom}
tbody th{font-weight:500}td{overflow-wrap:break-word;min-width:4em}
details{margin:10px 0}summary{cursor:pointer;color:var(--blue)}pre{overflow-x:auto;background:var(--soft);padding:12px;
 font:12px/1.45 ui-monospace,Menlo,Consolas,monospace}
a.term{color:inherit;text-decoration:underline dotted;text-underline-offset:3px}a.term:hover{color:var(--blue)}
#glossary{max-width:1180px;margin:0 auto;padding:0 24px 24px}#glossary h2{display:inline-block;font-weight:500;
 width:calc(100% - 1.2em);vertical-align:top}#glossary h2::before{content:none}
.glossary{columns:2 420px;column-gap:40px;font-size:14px}.glossary dt{font-weight:600;break-after:avoid}
.glossary dt:target{background:var(--mark)}.glossary dd{margin:0 0 8px;break-inside:avoid}
.glossary dd span{color:var(--grey)}
footer p{color:var(--grey);font-size:13px;border-top:1px solid var(--line);margin:0;padding:14px 0 40px;max-width:none}
@media (max-width:600px){body{font-size:15px}main,header.top,footer,#glossary{padding:0 14px}
 .gallery{grid-template-columns:1fr 1fr;gap:8px}.gallery li{padding:6px}nav{padding:7px 14px}
 .twinbar{font-size:13px}.card strong{font-size:21px}.cards{grid-template-columns:1fr 1fr;gap:8px}h2{font-size:20px}
 caption{max-width:calc(100vw - 28px)}td code{display:block;min-width:17em}
 .stacked table,.stacked tbody,.stacked tr,.stacked tbody th,.stacked td{display:block}
 .stacked caption{display:block}.stacked thead{position:absolute;left:-9999px}
 .stacked tr{border-top:2px solid var(--ink);padding:4px 0 10px}.stacked tbody th{font-weight:600;padding-right:0}
 .stacked td{display:flex;justify-content:space-between;gap:16px;padding-right:0;text-align:right}
 .stacked td::before{content:attr(data-column);color:var(--grey);text-align:left}}
@media print{@page{size:A4;margin:14mm 12mm}h2,h3{break-after:avoid}section.first:not(:last-of-type){break-after:page}
 section:has(>details:not([open])),#glossary:has(>details:not([open])){display:none}tr,.card,.notice{break-inside:avoid}
 main:has(section>details:not([open]))::after{content:"Folded sections are not printed. Open them on the page first.";
 display:block;font-size:8pt;color:var(--grey)}
 .twinbar,.notice,.card,.twin,.severity{-webkit-print-color-adjust:exact;print-color-adjust:exact}
 body{font-size:10pt;line-height:1.42}section.first>p:last-child{font-size:8pt;max-width:none}
 h1{font-size:16pt}.lead{font-size:10pt;max-width:none}
 .sticky{position:static}.twinbar{font-size:8.5pt}
 a.term{border:0;text-decoration:none;color:inherit}nav,.choices,.search,.tools,footer{display:none}
 main,header.top{padding:0 1px;max-width:none}section{margin:20px 0}
 .cards{grid-template-columns:repeat(5,minmax(0,1fr));gap:6px;margin:8px 0}figure{margin:10px 0}
 .card{padding:6px 8px}.card strong{font-size:12pt}
 .card span,.card small{font-size:8pt}.plot{min-width:0!important}.single .plot svg{max-height:120mm}
 .pairs,.columns,.panels{grid-template-columns:minmax(0,1fr) minmax(0,1fr)!important;gap:6px}
 .single .panels,.pairs .panels{grid-template-columns:minmax(0,1fr)!important}
 figcaption,table,caption{font-size:8pt}th,td{padding:2px 8px 2px 0}
 .columns td,.runs td,.runs tbody th,.named{white-space:normal}td{min-width:2.5em}.table{overflow:visible}
 .runs table{font-size:7pt}.runs td,.runs th{min-width:0;padding-right:5px;overflow-wrap:anywhere}}
""".replace("FONT", FONT)
