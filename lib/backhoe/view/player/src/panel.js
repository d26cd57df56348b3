// Buttons, scrub bar, readouts and keys.
import style from "./style.css";

const icons = {
  play: '<path class="solid" d="M8 5l11 7-11 7z"/>',
  pause: '<path class="solid" d="M7 5h3.4v14H7zM13.6 5H17v14h-3.4z"/>',
  reset: '<path d="M4 11a8 8 0 1 1 2.3 6.2M4 5v6h6"/>',
  side: '<path d="M3 18h18M5 18v-6h7v6M12 12l5-6 3 5"/>',
  top: '<path d="M12 3v10M8 9l4 4 4-4M4 17h16v4H4z"/>',
  follow: '<circle cx="12" cy="12" r="6.5"/><path d="M12 2v5M12 17v5M2 12h5M17 12h5"/>',
  trail: '<path stroke-dasharray="1 3.4" d="M4 19C6 9 12 15 14 9"/><circle class="solid" cx="17" cy="6" r="2.6"/>',
  full: '<path d="M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5"/>',
  help: '<path d="M8.5 9a3.5 3.5 0 1 1 5 3.2c-1 .6-1.5 1.2-1.5 2.6M12 18.6v.2"/>',
};
const icon = (name) => `<svg viewBox="0 0 24 24" aria-hidden="true">${icons[name]}</svg>`;

const views = [
  ["reset", "First view (R)"], ["side", "From the side (1)"], ["top", "From above (2)"],
  ["follow", "Follow the bucket (3)"], ["trail", "Path of the bucket (T)"],
  ["full", "Full screen (F)"], ["help", "Keys (?)"],
];
const speeds = [0.25, 0.5, 1, 2, 4];
const keysHelp = [
  ["Space", "play or pause"], ["← →", "half a second back or on"], [", .", "one frame back or on"],
  ["Home End", "first or last frame"], ["< >", "slower or faster"],
  ["Shift + arrows", "turn the view"], ["+ −", "closer or farther"], ["W A S D", "shift the view"],
  ["R 1 2 3", "first view, side, above, follow"], ["T F", "path of the bucket, full screen"],
  ["Mouse", "drag turns, right button shifts, wheel zooms once clicked"],
  ["Touch", "drag sideways turns, two fingers zoom and shift"],
];
const definitions = (rows) => `<dl>${rows.map(([a, b]) => `<dt>${a}</dt><dd>${b}</dd>`).join("")}</dl>`;

export class Panel {
  constructor(body, { alt, duration, scalars, has }) {
    document.head.append(Object.assign(document.createElement("style"), { textContent: style }));
    this.duration = duration;
    this.scalars = scalars;
    const root = document.createElement("div");
    root.className = "player";
    root.innerHTML = `<div class="stage">
      <canvas tabindex="0" role="img"></canvas>
      <div class="readout"><div class="phase" role="status"></div><dl></dl></div>
      <button class="first" aria-label="Play">${icon("play")}</button>
      <div class="views" role="toolbar" aria-label="View">${views
        .filter(([name]) => has[name] ?? true)
        .map(([name, label]) => `<button data-do="${name}" aria-label="${label}" title="${label}">${icon(name)}</button>`)
        .join("")}</div>
      <div class="help" role="dialog" aria-label="Keys" hidden><h2>Keys and gestures</h2>${definitions(keysHelp)}</div>
    </div>
    <div class="bar">
      <button data-do="play"></button>
      <input type="range" min="0" max="${duration}" step="any" value="0" aria-label="Time">
      <span class="time"></span>
      <select aria-label="Speed" title="Speed (< >)">${speeds.map((s) => `<option value="${s}">${s}×</option>`).join("")}</select>
    </div>`;
    body.append(root);
    this.root = root;
    const find = (selector) => root.querySelector(selector);
    this.stage = find(".stage");
    this.canvas = find("canvas");
    this.canvas.setAttribute("aria-label", `3D view. ${alt}`);
    this.first = find(".first");
    this.range = find("input");
    this.time = find(".time");
    this.speed = find("select");
    this.speed.value = "1";
    this.phase = find(".phase");
    this.values = scalars.map(({ label }) => {
      const [name, value] = [document.createElement("dt"), document.createElement("dd")];
      name.textContent = label;
      find(".readout dl").append(name, value);
      return value;
    });
    this.setPlaying(false);
  }

  button(name) {
    return this.root.querySelector(`[data-do="${name}"]`);
  }

  press(name, on) {
    this.button(name)?.setAttribute("aria-pressed", String(on));
  }

  setPlaying(playing) {
    const button = this.button("play");
    const label = playing ? "Pause" : "Play";
    button.innerHTML = icon(playing ? "pause" : "play");
    button.setAttribute("aria-label", label);
    button.title = `${label} (space)`;
    if (playing) this.first.hidden = true;
  }

  toggleHelp(on) {
    const help = this.root.querySelector(".help");
    help.hidden = on === undefined ? !help.hidden : !on;
    this.press("help", !help.hidden);
  }

  show(time, frame, phase) {
    this.range.value = time;
    this.range.setAttribute("aria-valuetext", `${time.toFixed(1)} of ${this.duration.toFixed(1)} seconds`);
    this.time.textContent = `${time.toFixed(1)} / ${this.duration.toFixed(1)} s`;
    this.scalars.forEach(({ values, unit, digits }, i) => {
      const value = values[Math.round(frame)];
      this.values[i].textContent = `${(Math.abs(value) < 0.5 * 10 ** -digits ? 0 : value).toFixed(digits)} ${unit}`;
    });
    this.root.querySelector(".readout").hidden = !this.scalars.length && !phase;
    if (this.phase.textContent !== phase) this.phase.textContent = phase;
  }

  changeSpeed(steps) {
    const next = speeds.indexOf(Number(this.speed.value)) + steps;
    this.speed.value = String(speeds[Math.min(speeds.length - 1, Math.max(0, next))]);
  }
}

// `actions` by key; Space and arrows stay with the element that has the focus where it needs them
export function listen(panel, actions) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const own = event.target.closest?.("button, select");
    if (own && (event.key === " " || event.key === "Enter")) return;
    if (own?.tagName === "SELECT" && event.key.startsWith("Arrow")) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const action = actions[(event.shiftKey && key.startsWith("Arrow") ? "Shift+" : "") + key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
