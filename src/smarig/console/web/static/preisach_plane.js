// The Preisach plane with the boundary of the memory: β to the right, α upwards, as an SVG whose colours are in the style sheet.
const SVG = "http://www.w3.org/2000/svg";
const [LEFT, RIGHT, TOP, BOTTOM] = [58, 16, 12, 48];
const HEIGHT = 420;

function add(parent, name, attributes, text = "") {
  const made = parent.appendChild(document.createElementNS(SVG, name));
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  return made;
}

// Round numbers within a range, about five of them.
function ticks(low, high) {
  const rough = (high - low) / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough * (1 - 1e-9));
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, k) => +((first + k) * step).toPrecision(12));
}

const number = (value) => String(value).replace("-", "−");

export class PreisachPlane {
  constructor(figure) {
    this.place = figure.querySelector(".plane");
    this.figure = figure;
    this.unit = "K";
    new ResizeObserver(() => this.draw()).observe(this.place);
  }

  show(found) {
    this.found = found;
    this.figure.hidden = false;
    this.draw();
  }

  draw() {
    if (!this.found || !this.place.clientWidth) return;
    const { range: [low, high], corners, count, input } = this.found;
    const side = Math.min(this.place.clientWidth - LEFT - RIGHT, HEIGHT - TOP - BOTTOM);
    const x = (value) => LEFT + side * (value - low) / (high - low);
    const y = (value) => TOP + side * (high - value) / (high - low);
    const path = (points) => points.map(([b, a], k) => `${k ? "L" : "M"}${x(b).toFixed(1)} ${y(a).toFixed(1)}`).join("");
    const [width, height] = [LEFT + side + RIGHT, TOP + side + BOTTOM];
    const svg = document.createElementNS(SVG, "svg");
    for (const [key, value] of Object.entries({ width, height, viewBox: `0 0 ${width} ${height}`, "aria-hidden": "true" })) {
      svg.setAttribute(key, value);
    }
    add(svg, "path", { class: "half", d: path([[low, low], [low, high], [high, high]]) + "Z" });
    add(svg, "path", { class: "up", d: path([[low, low], ...corners]) + "Z" });
    for (const value of ticks(low, high)) {
      add(svg, "path", { class: "tick", d: `M${x(value)} ${TOP + side}v5M${LEFT} ${y(value)}h-5` });
      add(svg, "text", { class: "x", x: x(value), y: TOP + side + 19 }, number(value));
      add(svg, "text", { class: "y", x: LEFT - 9, y: y(value) + 4.5 }, number(value));
    }
    add(svg, "path", { class: "frame", d: `M${LEFT} ${TOP}v${side}h${side}` });
    add(svg, "path", { class: "boundary", d: path([[low, high], ...corners]) });
    const [b, a] = corners.at(-1);
    add(svg, "circle", { class: "present", cx: x(b), cy: y(a), r: 5.5 });
    add(svg, "text", { class: "label x", x: LEFT + side / 2, y: height - 8 }, `β, ${this.unit}`);
    add(svg, "text", { class: "label x", transform: `translate(14 ${TOP + side / 2}) rotate(-90)` }, `α, ${this.unit}`);
    this.place.replaceChildren(svg);
    this.place.setAttribute("aria-label", `Preisach plane: present input ${number(input)} ${this.unit}, boundary with ${count} ${count === 1 ? "corner" : "corners"}`);
    this.place.dataset.count = count;
  }
}
