"""The script of a page: draws its figures one after the other, and once more for paper.

Choices that Plotly would draw as pictures of buttons become real ones, so that keys and screen readers
reach them. Knows no data; loads nothing.
"""

import json

from smarig.report.style import template

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
    """The script, with the template all figures share in it."""
    return _DRAW_SCRIPT.replace("TEMPLATE", json.dumps(template()))
