// A run as it grows: loop, boundary, last minutes, residual, settling, events. Memory stays bounded: full stores drop
// every other point.
import { offline } from "./connection.js";
import { announce, heading, notifyButton } from "./notify.js";
import { PreisachPlane } from "./preisach_plane.js";

const MOST = 4000; // points of each curve
const LAST_S = 600; // of the plot against time
const live = document.getElementById("live");
const key = live.dataset.key;
const unit = live.dataset.unit;
const model = new URLSearchParams(location.search).get("model") ?? "";
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

class Store {
  constructor(columns) {
    this.columns = Array.from({ length: columns }, () => []);
  }
  add(rows) {
    for (const row of rows) row.forEach((value, k) => this.columns[k].push(value));
    if (this.columns[0].length > MOST) {
      this.columns = this.columns.map((column) => column.filter((_, i) => i % 2 === column.length % 2));
    }
  }
  dropBefore(time) {
    const first = this.columns[0].findIndex((t) => t >= time);
    if (first > 200) this.columns = this.columns.map((column) => column.slice(first));
  }
}

const loop = new Store(3); // input, position, model
const recent = new Store(4); // time, position, current, residual

function axis(label, extra = {}) {
  const line = () => colour("--line"); // asked at each drawing: a page may change between light and dark
  return { label, stroke: () => colour("--ink"), grid: { stroke: line, width: 1 }, ticks: { stroke: line }, ...extra };
}

function size(element) {
  return { width: element.clientWidth, height: Math.max(260, Math.min(420, element.clientWidth * 0.62)) };
}

// uPlot draws rising abscissae; a loop goes back, so its path is drawn point by point.
function path(u, series) {
  const p = new Path2D();
  const [x, y] = [u.data[series][0], u.data[series][1]];
  let pen = false;
  for (let i = 0; i < x.length; i++) {
    if (y[i] == null || x[i] == null) { pen = false; continue; }
    const [a, b] = [u.valToPos(x[i], "x", true), u.valToPos(y[i], "y", true)];
    if (pen) p.lineTo(a, b); else p.moveTo(a, b);
    pen = true;
  }
  return { stroke: p, fill: null, clip: null, flags: 1 };
}

function range(columns) {
  let [low, high] = [Infinity, -Infinity];
  for (const column of columns) for (const value of column) {
    if (value == null) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (!(low <= high)) return [0, 1];
  const margin = 0.05 * (high - low || 1);
  return [low - margin, high + margin];
}

const loopElement = document.getElementById("loop");
const loopPlot = new uPlot({
  ...size(loopElement), mode: 2, legend: { show: false }, cursor: { show: false },
  scales: {
    x: { time: false, auto: false },
    y: { auto: false },
  },
  axes: [axis(`${live.dataset.input}, K`), axis(`position, ${unit}`)],
  series: [{}, { stroke: () => colour("--model"), width: 3, paths: path }, { stroke: () => colour("--cooling"), width: 1.2, paths: path }],
}, [null, [[], []], [[], []]], loopElement);

const timeElement = document.getElementById("time");
const timePlot = new uPlot({
  ...size(timeElement), cursor: { show: false }, legend: { live: false },
  scales: { x: { time: false }, A: {} },
  axes: [axis("time, s"), axis(`position, ${unit}`), axis("current, A", { scale: "A", side: 1, grid: { show: false } })],
  series: [
    { label: "time" },
    { label: `position, ${unit}`, stroke: () => colour("--cooling"), width: 1.2, points: { show: false } },
    { label: "current, A", scale: "A", stroke: () => colour("--heating"), width: 1, points: { show: false } },
  ],
}, [[], [], []], timeElement);

// Measured minus modelled position; only where a model was chosen.
const residualElement = document.getElementById("residual");
const residualPlot = residualElement && new uPlot({
  ...size(residualElement), cursor: { show: false }, legend: { show: false },
  scales: { x: { time: false }, y: { range: (u, low, high) => range([[low, high, 0]]) } },
  axes: [axis("time, s"), axis(`residual, ${unit}`, { size: 72 })],
  series: [{}, { stroke: () => colour("--model"), width: 0.8, points: { show: false } }],
  hooks: { drawAxes: [zeroLine] },
}, [[], []], residualElement);

function zeroLine(u) {
  const y = u.valToPos(0, "y", true);
  u.ctx.save();
  u.ctx.strokeStyle = colour("--grey");
  u.ctx.lineWidth = devicePixelRatio;
  u.ctx.beginPath();
  u.ctx.moveTo(u.bbox.left, y);
  u.ctx.lineTo(u.bbox.left + u.bbox.width, y);
  u.ctx.stroke();
  u.ctx.restore();
}

const plane = new PreisachPlane(document.getElementById("plane-figure"));

function draw() {
  loopPlot.batch(() => {
    loopPlot.setData([null, [loop.columns[0], loop.columns[2]], [loop.columns[0], loop.columns[1]]], false);
    for (const [scale, columns] of [["x", [loop.columns[0]]], ["y", [loop.columns[1], loop.columns[2]]]]) {
      const [min, max] = range(columns);
      loopPlot.setScale(scale, { min, max });
    }
  });
  timePlot.setData(recent.columns.slice(0, 3));
  residualPlot?.setData([recent.columns[0], recent.columns[3]]);
  if (residualPlot) residualElement.dataset.largest = Math.max(...recent.columns[3].map(Math.abs));
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  for (const plot of [loopPlot, timePlot, residualPlot]) plot?.redraw(false);
});

new ResizeObserver(() => {
  loopPlot.setSize(size(loopElement));
  timePlot.setSize(size(timeElement));
  residualPlot?.setSize(size(residualElement));
}).observe(loopElement);

function samples(rows) {
  loop.add(rows.map(([, input, position, , modelled]) => [input, position, modelled]));
  recent.add(rows.map(([t, , y, current, modelled]) => [t, y, current, y == null || modelled == null ? null : y - modelled]));
  if (rows.length) recent.dropBefore(rows.at(-1)[0] - LAST_S);
  requestAnimationFrame(() => {
    draw();
    if (rows.length) live.dataset.drawn = rows.at(-1)[0];
  });
}

function status(now) {
  document.getElementById("state").textContent = now.state;
  document.getElementById("facts").textContent = now.facts;
  document.getElementById("settling").textContent = now.settling || "No step is settling.";
  const share = document.getElementById("share");
  if (now.share == null) share.removeAttribute("value"); else share.value = now.share;
  for (const [id, off] of [["pause", now.paused], ["go-on", !now.paused]]) {
    const button = document.getElementById(id);
    if (button) button.disabled = off;
  }
}

function events(list) {
  const place = document.getElementById("events");
  for (const event of list) {
    const item = document.createElement("li");
    item.className = event.severity;
    for (const [name, text] of [["at", event.at], ["severity", event.severity], ["text", event.text]]) {
      const part = item.appendChild(document.createElement("span"));
      part.className = name;
      part.textContent = text;
    }
    place.prepend(item);
  }
  while (place.children.length > 200) place.lastChild.remove();
}

let isEnded = false;

function ended(now) {
  isEnded = true;
  status({ ...now, share: 1, settling: "", paused: false });
  for (const id of ["controls", "controls-help", "notify-me"]) document.getElementById(id)?.remove();
  document.getElementById("plots").hidden = !recent.columns[0].length;
  document.getElementById("ended").hidden = false;
  announce(heading(now.level, live.dataset.title), now.state);
}

// While nobody sees the page: ask for the end of the run until it comes, or until the page is seen again.
function lookForTheEnd() {
  const look = setInterval(async () => {
    try {
      const now = await (await fetch(`/runs/${key}/state?file=${encodeURIComponent(live.dataset.file)}`)).json();
      if (!now.in_progress && !isEnded) {
        clearInterval(look);
        ended({ ...now, facts: "" });
      }
    } catch { /* the console does not answer; asked again */ }
  }, 2000);
  document.addEventListener("visibilitychange", () => {
    clearInterval(look);
    if (!isEnded) follow();
  }, { once: true });
}

const SILENT_MS = 5000;

function follow() {
  const source = new EventSource(`/runs/${key}/follow?model=${encodeURIComponent(model)}`);
  let heard = performance.now();
  const on = (name, act) => source.addEventListener(name, (message) => {
    heard = performance.now();
    offline(false);
    act(JSON.parse(message.data));
  });
  // A console that is stopped keeps its connection and says nothing.
  const watch = setInterval(() => {
    if (source.readyState === EventSource.CLOSED) clearInterval(watch);
    else if (performance.now() - heard > SILENT_MS) offline(true);
  }, 1000);
  on("alive", () => {});
  on("history", (rows) => {
    loop.columns = [[], [], []];
    recent.columns = [[], [], [], []];
    document.getElementById("events").replaceChildren();
    samples(rows);
  });
  on("samples", samples);
  on("boundary", (found) => plane.show(found));
  on("status", status);
  on("events", events);
  on("ended", (now) => {
    source.close();
    ended(now);
  });
  // A browser has six connections for one address: a page that nobody sees gives its own back, and looks now and then.
  const hide = () => {
    if (isEnded || document.visibilityState === "visible") return;
    source.close();
    document.removeEventListener("visibilitychange", hide);
    lookForTheEnd();
  };
  document.addEventListener("visibilitychange", hide);
  source.onopen = () => offline(false);
  source.onerror = () => offline(true); // the browser tries again by itself
}

notifyButton();
follow();
