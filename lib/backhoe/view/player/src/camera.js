// Orbit, pan and zoom around a target, with mouse, touch and keys; z is up.
import { PerspectiveCamera, Vector3 } from "three";

const WIDTH_OF_VIEW = (52 * Math.PI) / 180;
const LOWEST = 0.03, HIGHEST = Math.PI / 2 - 0.02;
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

export class Orbit {
  constructor(element, start, changed) {
    this.camera = new PerspectiveCamera(40, 1, 0.1, 900);
    this.camera.up.set(0, 0, 1);
    this.target = new Vector3();
    this.element = element;
    this.changed = changed;
    this.start = start;
    this.pointers = new Map();
    this.look(start.eye, start.target);
    element.addEventListener("pointerdown", (event) => this.down(event));
    element.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"]) {
      element.addEventListener(end, (event) => this.pointers.delete(event.pointerId));
    }
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    element.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  look(eye, target) {
    this.target.set(...target);
    const [x, y, z] = eye.map((value, i) => value - target[i]);
    this.distance = Math.hypot(x, y, z);
    this.azimuth = Math.atan2(y, x);
    this.elevation = Math.asin(z / this.distance);
    this.update();
  }

  resize(width, height) {
    const aspect = width / height;
    const half = Math.tan(WIDTH_OF_VIEW / 2);
    this.camera.aspect = aspect;
    this.camera.fov = (2 * Math.atan(Math.max(0.42, half / aspect)) * 180) / Math.PI;
    if (aspect < 1) this.camera.fov = (2 * Math.atan(half / aspect / 1.35) * 180) / Math.PI;
    this.camera.updateProjectionMatrix();
  }

  update() {
    this.elevation = clamp(this.elevation, LOWEST, HIGHEST);
    this.distance = clamp(this.distance, 2, 60);
    this.target.z = clamp(this.target.z, -2, 12);
    const flat = this.distance * Math.cos(this.elevation);
    this.camera.position.set(
      this.target.x + flat * Math.cos(this.azimuth),
      this.target.y + flat * Math.sin(this.azimuth),
      this.target.z + this.distance * Math.sin(this.elevation),
    );
    this.camera.lookAt(this.target);
    this.changed();
  }

  turn(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation += elevation;
    this.update();
  }

  zoom(factor) {
    this.distance *= factor;
    this.update();
  }

  pan(right, up) {
    const metres = (2 * this.distance * Math.tan((this.camera.fov * Math.PI) / 360)) / this.element.clientHeight;
    const side = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const upwards = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    this.target.addScaledVector(side, right * metres).addScaledVector(upwards, up * metres);
    this.update();
  }

  down(event) {
    this.element.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    this.moved?.();
  }

  move(event) {
    const last = this.pointers.get(event.pointerId);
    if (!last) return;
    const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
    if (this.pointers.size === 1) {
      this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
      if (event.buttons & 2 || event.shiftKey) this.pan(-dx, dy);
      else this.turn(-dx * 0.008, dy * 0.008);
    } else if (this.pointers.size === 2) {
      const [a, b] = [...this.pointers.values()];
      const before = Math.hypot(a[0] - b[0], a[1] - b[1]);
      this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
      const [c, d] = [...this.pointers.values()];
      const after = Math.hypot(c[0] - d[0], c[1] - d[1]);
      this.pan(-dx / 2, dy / 2);
      if (after > 0) this.zoom(before / after);
    }
  }

  // the page scrolls until the player has been clicked or tabbed into
  wheel(event) {
    if (!document.hasFocus()) return;
    event.preventDefault();
    this.zoom(Math.exp(clamp(event.deltaY, -120, 120) * 0.0015));
  }
}
