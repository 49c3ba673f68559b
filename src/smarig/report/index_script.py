"""The script of an index page: search, filters and order, for pictures and table at once. Needs no server.

Without it the page shows everything, in the order in which it was written.
"""

INDEX_SCRIPT = """
(function(){
 const rows=[...document.querySelectorAll('tbody tr[data-run]')];
 const cards=rows.map(row=>document.querySelector('li[data-run="'+row.dataset.run+'"]'));
 const form=document.querySelector('.search'), status=form.querySelector('[role=status]');
 const heads=[...document.querySelectorAll('th[data-key]')];
 let key='began', falling=false;
 form.hidden=false;
 function show(){
  const words=form.words.value.toLowerCase().split(/\\s+/).filter(Boolean);
  const wanted=['protocol','rig','ended'].map(name=>[name,form[name].value]);
  let n=0;
  rows.forEach((row,k)=>{
   const hit=words.every(w=>row.dataset.text.includes(w))&&wanted.every(([name,v])=>!v||row.dataset[name]===v);
   row.hidden=cards[k].hidden=!hit; n+=hit;
  });
  status.textContent=n+' of '+rows.length+' runs';
 }
 function value(row){ const v=row.dataset[key]??'', x=Number(v); return v!==''&&!isNaN(x)?x:v; }
 function compare(a,b){
  const x=value(rows[a]), y=value(rows[b]);
  if(x===y) return a-b;
  if(x==='') return 1; if(y==='') return -1;
  const less=typeof x==='number'&&typeof y==='number'?x<y:String(x).localeCompare(String(y),undefined,{numeric:true})<0;
  return less!==falling?-1:1;
 }
 function order(){
  const sorted=rows.map((_,k)=>k).sort(compare);
  const body=rows.length&&rows[0].parentNode, list=cards.length&&cards[0].parentNode;
  sorted.forEach(k=>{ body.append(rows[k]); list.append(cards[k]); });
  heads.forEach(th=>th.setAttribute('aria-sort',th.dataset.key!==key?'none':falling?'descending':'ascending'));
  form.sort.value=key; form.falling.setAttribute('aria-pressed',falling);
 }
 heads.forEach(th=>{ const button=document.createElement('button'); button.type='button';
  button.textContent=th.textContent; th.replaceChildren(button);
  button.onclick=()=>{ falling=key===th.dataset.key&&!falling; key=th.dataset.key; order(); }; });
 form.sort.onchange=()=>{ key=form.sort.value; order(); };
 form.falling.onclick=()=>{ falling=!falling; order(); };
 form.oninput=show;
 form.onsubmit=event=>event.preventDefault();
 order(); show();
})();
"""
