// The replay's player: `backhoePlayer.start(body, recording)` builds it into an empty page.
import {
  BufferAttribute, BufferGeometry, Color, Line, LineBasicMaterial, PCFShadowMap, Scene, Vector3,
  WebGLRenderer,
} from "three";
import { Orbit } from "./camera.js";
import { decode } from "./format.js";
import { Field, Surround } from "./ground.js";
import { Surroundings, themes } from "./look.js";
import { buildNodes } from "./meshes.js";
import { Motion } from "./motion.js";
import { listen, Panel } from "./panel.js";

const SHADOW_RADIUS = 11; // around the machine [m]
const SLOW = 90; // between two pictures [ms]

class Player {
  constructor(body, buffer) {
    const recording = (this.recording = decode(buffer));
    const { times } = recording;
    this.times = times.map((t) => t - times[0]);
    this.labels = recording.labels.map(([t, text]) => [t - times[0], text]);
    this.frames = times.length;
    this.duration = this.times[this.frames - 1];
    this.motion = new Motion(recording.nodes);
    this.panel = new Panel(body, {
      alt: body.dataset.alt,
      duration: this.duration,
      scalars: recording.scalars,
      has: {
        follow: recording.follow >= 0,
        trail: recording.trail >= 0,
        full: document.fullscreenEnabled,
      },
    });
    this.renderer = new WebGLRenderer({
      canvas: this.panel.canvas,
      antialias: !drawnInSoftware(),
      preserveDrawingBuffer: true, // so that the page can be printed and copied
    });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.build();
    this.orbit = new Orbit(this.panel.canvas, recording.camera, () => this.refresh());
    this.time = this.times[Math.min(this.frames - 1, Number(body.dataset.poster) || 0)];
    this.playing = false;
    this.connect();
    this.resize();
  }

  build() {
    const { recording } = this;
    const scene = (this.scene = new Scene());
    const strength = (this.gridStrength = { value: 0 });
    this.surroundings = new Surroundings(scene, SHADOW_RADIUS);
    const { groups, morphs } = buildNodes(recording, scene);
    this.groups = groups;
    this.morphs = morphs;
    this.fields = recording.fields.map((field) => new Field(field, strength));
    for (const field of this.fields) {
      (field.node >= 0 ? groups[field.node] : scene).add(field.object);
    }
    this.surround = new Surround(
      recording.fields.find((field) => !field.bed && field.node < 0),
      strength,
    );
    scene.add(this.surround.object);
    for (const line of recording.lines) {
      scene.add(polyline(line.points, new Color().setRGB(...line.colour.slice(0, 3), "srgb")));
    }
    this.dark = matchMedia("(prefers-color-scheme: dark)");
    this.useTheme();
  }

  useTheme() {
    const theme = themes[this.dark.matches ? "dark" : "light"];
    this.gridStrength.value = theme.grid;
    this.surroundings.use(theme);
    this.surround.use(theme);
    for (const field of this.fields) field.use(theme);
    this.trail?.material.color.set(theme.trail);
    this.theme = theme;
  }

  connect() {
    const { panel, orbit } = this;
    const seek = (by) => this.seek(this.time + by);
    const step = (by) => {
      const frame = Math.round(this.frameAt(this.time)) + by;
      this.seek(this.times[Math.min(this.frames - 1, Math.max(0, frame))]);
    };
    const shift = 30, angle = 0.12;
    const actions = {
      play: () => this.toggle(),
      reset: () => this.view(this.recording.camera.eye, this.recording.camera.target),
      side: () => this.preset([0, -13, 2.5]),
      top: () => this.preset([0, -0.4, 17]),
      follow: () => this.follow(!this.following),
      trail: () => this.showTrail(!this.trail?.visible),
      full: () =>
        document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen(),
      help: () => panel.toggleHelp(),
    };
    listen(panel, {
      " ": actions.play,
      ArrowLeft: () => seek(-0.5),
      ArrowRight: () => seek(0.5),
      ",": () => step(-1),
      ".": () => step(1),
      Home: () => this.seek(0),
      End: () => this.seek(this.duration),
      "<": () => panel.changeSpeed(-1),
      ">": () => panel.changeSpeed(1),
      "Shift+ArrowLeft": () => orbit.turn(-angle, 0),
      "Shift+ArrowRight": () => orbit.turn(angle, 0),
      "Shift+ArrowUp": () => orbit.turn(0, angle),
      "Shift+ArrowDown": () => orbit.turn(0, -angle),
      "+": () => orbit.zoom(0.87),
      "=": () => orbit.zoom(0.87),
      "-": () => orbit.zoom(1.15),
      w: () => orbit.pan(0, shift),
      s: () => orbit.pan(0, -shift),
      a: () => orbit.pan(-shift, 0),
      d: () => orbit.pan(shift, 0),
      r: actions.reset,
      1: actions.side,
      2: actions.top,
      3: actions.follow,
      t: actions.trail,
      f: actions.full,
      "?": actions.help,
      Escape: () => panel.toggleHelp(false),
    });
    for (const button of panel.root.querySelectorAll("[data-do]")) {
      button.addEventListener("click", actions[button.dataset.do]);
    }
    panel.first.addEventListener("click", () => {
      this.toggle();
      panel.canvas.focus({ preventScroll: true });
    });
    panel.range.addEventListener("input", () => this.seek(Number(panel.range.value)));
    this.dark.addEventListener("change", () => {
      this.useTheme();
      this.refresh();
    });
    new ResizeObserver(() => this.resize()).observe(panel.stage);
  }

  toggle() {
    this.playing = !this.playing;
    if (this.playing && this.time >= this.duration) this.time = 0;
    this.clock = undefined;
    this.panel.setPlaying(this.playing);
    this.refresh();
  }

  seek(time) {
    this.time = Math.min(this.duration, Math.max(0, time));
    this.panel.first.hidden = true;
    this.refresh();
  }

  frameAt(time) {
    let low = 0, high = this.frames - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.times[middle] <= time) low = middle;
      else high = middle;
    }
    if (high === low) return low;
    return low + Math.min(1, (time - this.times[low]) / (this.times[high] - this.times[low]));
  }

  view(eye, target) {
    this.follow(false);
    this.orbit.look(eye, target);
  }

  preset(offset) {
    const { target } = this.recording.camera;
    this.view(target.map((x, i) => x + offset[i]), target);
  }

  follow(on) {
    this.following = on;
    this.panel.press("follow", on);
    if (!on) return;
    this.orbit.target.copy(this.followed());
    this.followedLast = this.followed();
    this.orbit.distance = 9;
    this.orbit.update();
  }

  followed() {
    return new Vector3().setFromMatrixPosition(this.motion.nodes[this.recording.follow].world);
  }

  showTrail(on) {
    if (!this.trail) {
      this.trail = polyline(this.motion.path(this.recording.trail, this.frames), new Color(this.theme.trail));
      this.trail.material.depthTest = false;
      this.trail.renderOrder = 1;
      this.scene.add(this.trail);
    }
    this.trail.visible = on;
    this.panel.press("trail", on);
    this.refresh();
  }

  resize() {
    const { clientWidth, clientHeight } = this.panel.stage;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setPixelRatio(this.economy === 2 ? 0.6 : Math.min(2, devicePixelRatio));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.orbit.resize(clientWidth, clientHeight);
    this.refresh();
  }

  // nothing is drawn while nothing changes
  refresh() {
    this.waiting ??= requestAnimationFrame((now) => this.draw(now));
  }

  draw(now) {
    this.waiting = undefined;
    if (this.playing) {
      if (this.clock !== undefined) {
        const passed = Math.min(1000, now - this.clock);
        this.time += (passed / 1000) * Number(this.panel.speed.value);
        this.keepUp(passed);
      }
      this.clock = now;
      if (this.time >= this.duration) {
        this.time = this.duration;
        this.playing = false;
        this.panel.setPlaying(false);
      }
    }
    this.pose();
    this.renderer.render(this.scene, this.orbit.camera);
    if (this.playing) this.refresh();
  }

  // without a graphics card: first drop the shadows, then draw fewer pixels
  keepUp(passed) {
    this.slow = passed > SLOW ? (this.slow ?? 0) + 1 : 0;
    if (this.slow < 6 || this.economy === 2) return;
    this.slow = 0;
    this.economy = (this.economy ?? 0) + 1;
    this.surroundings.sun.castShadow = false;
    this.resize();
  }

  pose() {
    const frame = this.frameAt(this.time);
    this.motion.pose(frame);
    this.groups.forEach((group, i) => {
      group.matrix.copy(this.motion.nodes[i].world);
      group.matrixWorldNeedsUpdate = true;
    });
    for (const field of this.fields) field.seek(Math.floor(frame));
    for (const morph of this.morphs) morph.show(frame);
    if (this.following) {
      const now = this.followed();
      this.orbit.target.add(now).sub(this.followedLast);
      this.followedLast = now;
      this.orbit.changed = () => {};
      this.orbit.update();
      this.orbit.changed = () => this.refresh();
    }
    this.trail?.geometry.setDrawRange(0, Math.floor(frame) + 1);
    if (this.groups.length) {
      this.surroundings.centre(new Vector3().setFromMatrixPosition(this.groups[0].matrix).add({ x: 3, y: 1, z: 0 }));
    }
    this.surroundings.sky.position.copy(this.orbit.camera.position);
    this.panel.show(this.time, frame, this.labels.findLast(([t]) => t <= this.time + 1e-6)?.[1] ?? "");
  }
}

// smooth edges double the time of a picture where no graphics card draws it
function drawnInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return false;
  const known = gl.getExtension("WEBGL_debug_renderer_info");
  const name = gl.getParameter(known ? known.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

function polyline(points, color) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  const line = new Line(geometry, new LineBasicMaterial({ color }));
  line.frustumCulled = false;
  return line;
}

export const start = (body, buffer) => new Player(body, buffer);
