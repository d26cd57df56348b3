// Height fields that change a few cells a frame, and the wide flat ground around them.
import { BufferAttribute, BufferGeometry, Color, Mesh } from "three";
import { groundMaterial } from "./look.js";

const FAR = 220;
const OVERLAP = 0.03; // of the surroundings and a field, so that no crack shows [m]
const UNDER = 0.03; // an empty bed hides below the floor [m]
const DUST = 0.01; // what counts as empty [m]

export class Field {
  constructor(field, strength) {
    Object.assign(this, field);
    [this.rows, this.columns] = field.shape;
    this.now = this.first.slice();
    this.frame = 0;
    this.starts = [0];
    for (const count of this.counts) this.starts.push(this.starts.at(-1) + count);
    this.touched = new Uint8Array(this.now.length);
    this.cells = cellsOf(this);
    for (const cell of this.cells) this.touched[cell] = 1;
    const n = this.now.length;
    const geometry = new BufferGeometry();
    this.position = new BufferAttribute(new Float32Array(3 * n), 3);
    this.normal = new BufferAttribute(new Float32Array(3 * n), 3);
    this.color = new BufferAttribute(new Float32Array(3 * n), 3);
    geometry.setAttribute("position", this.position);
    geometry.setAttribute("normal", this.normal);
    geometry.setAttribute("color", this.color);
    geometry.setIndex(new BufferAttribute(gridFaces(this.rows, this.columns), 1));
    this.object = new Mesh(geometry, groundMaterial(this.bed ? { value: 0 } : strength));
    this.object.receiveShadow = true;
    this.object.frustumCulled = false;
    for (let i = 0; i < n; i++) {
      this.position.setXYZ(
        i,
        this.origin[0] + this.cell * (i % this.columns),
        this.origin[1] + this.cell * Math.floor(i / this.columns),
        0,
      );
    }
  }

  use(theme) {
    this.palette = [theme.grass, theme.soil, theme.deep].map((name) => new Color(name));
    this.paint(0, this.rows - 1);
  }

  seek(frame) {
    if (frame === this.frame) return;
    let low = this.now.length, high = -1;
    const forward = frame > this.frame;
    const [a, b] = forward ? [this.frame, frame] : [frame, this.frame];
    for (let i = this.starts[a]; i < this.starts[b]; i++) {
      const cell = this.cells[i];
      this.now[cell] += forward ? this.deltas[i] : -this.deltas[i];
      if (cell < low) low = cell;
      if (cell > high) high = cell;
    }
    this.frame = frame;
    if (high >= 0) {
      this.paint(Math.floor(low / this.columns) - 1, Math.floor(high / this.columns) + 1);
    }
  }

  height(i) {
    const height = this.now[this.bed ? this.inside(i) : i] * this.step;
    return this.origin[2] + (this.bed && height < DUST ? -UNDER : height);
  }

  // the outermost cells of a bed lie in its walls: the load reaches into them
  inside(i) {
    const row = Math.min(this.rows - 2, Math.max(1, Math.floor(i / this.columns)));
    const column = Math.min(this.columns - 2, Math.max(1, i % this.columns));
    return row * this.columns + column;
  }

  paint(firstRow, lastRow) {
    const { rows, columns, cell, position, normal, color } = this;
    firstRow = Math.max(0, firstRow);
    lastRow = Math.min(rows - 1, lastRow);
    for (let i = firstRow * columns; i < (lastRow + 1) * columns; i++) {
      position.array[3 * i + 2] = this.height(i);
      this.tint(i);
    }
    for (let row = firstRow; row <= lastRow; row++) {
      const up = Math.min(rows - 1, row + 1) * columns, down = Math.max(0, row - 1) * columns;
      for (let column = 0; column < columns; column++) {
        const right = Math.min(columns - 1, column + 1), left = Math.max(0, column - 1);
        const here = row * columns;
        const dx = (this.height(here + right) - this.height(here + left)) / (cell * (right - left));
        const dy = (this.height(up + column) - this.height(down + column)) / (cell * ((up - down) / columns));
        const length = Math.hypot(dx, dy, 1);
        normal.setXYZ(here + column, -dx / length, -dy / length, 1 / length);
      }
    }
    for (const attribute of [position, normal, color]) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(3 * firstRow * columns, 3 * (lastRow - firstRow + 1) * columns);
      attribute.needsUpdate = true;
    }
  }

  // untouched flat ground is grass; heaps and whatever was moved are soil, darker where it is deep
  tint(i) {
    const [grass, soil, deep] = this.palette;
    const height = this.now[i] * this.step;
    const moved = this.touched[i] ? Math.abs(this.now[i] - this.first[i]) * this.step : 0;
    const bare = this.bed ? 1 : Math.min(1, Math.abs(height) / 0.08 + moved / 0.04);
    const fresh = Math.min(1, moved / 0.25);
    const depth = Math.min(1, Math.max(0, 0.15 - height * 0.35 + 0.45 * fresh));
    const grain = 1 + 0.07 * (((Math.imul(i + 1, 2654435761) >>> 16) & 255) / 255 - 0.5);
    const mix = (channel) => {
      const earth = soil[channel] + depth * (deep[channel] - soil[channel]);
      return (grass[channel] + bare * (earth - grass[channel])) * grain;
    };
    this.color.setXYZ(i, mix("r"), mix("g"), mix("b"));
  }
}

function cellsOf({ counts, gaps }) {
  const cells = new Int32Array(gaps.length);
  let at = 0;
  for (const count of counts) {
    let cell = -1;
    for (let i = 0; i < count; i++) cells[at] = cell += gaps[at++] + 1;
  }
  return cells;
}

function gridFaces(rows, columns) {
  const faces = new Uint32Array(6 * (rows - 1) * (columns - 1));
  let at = 0;
  for (let row = 0; row < rows - 1; row++) {
    for (let column = 0; column < columns - 1; column++) {
      const a = row * columns + column;
      faces.set([a, a + 1, a + columns, a + 1, a + columns + 1, a + columns], at);
      at += 6;
    }
  }
  return faces;
}

// flat ground to the horizon with a hole where a field lies
export class Surround {
  constructor(field, strength) {
    const [x0, y0] = field ? field.origin.map((start) => start + OVERLAP) : [0, 0];
    const x1 = field ? x0 + field.cell * (field.shape[1] - 1) - 2 * OVERLAP : 0;
    const y1 = field ? y0 + field.cell * (field.shape[0] - 1) - 2 * OVERLAP : 0;
    const rectangles = [
      [-FAR, -FAR, FAR, y0], [-FAR, y1, FAR, FAR], [-FAR, y0 - OVERLAP, x0, y1 + OVERLAP],
      [x1, y0 - OVERLAP, FAR, y1 + OVERLAP],
    ];
    const corners = rectangles.flatMap(([a, b, c, d]) => [a, b, 0, c, b, 0, a, d, 0, c, d, 0]);
    const count = corners.length / 3;
    const geometry = new BufferGeometry();
    this.color = new BufferAttribute(new Float32Array(3 * count), 3);
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(corners), 3));
    geometry.setAttribute("normal", new BufferAttribute(new Float32Array(3 * count).map((_, i) => (i % 3 === 2 ? 1 : 0)), 3));
    geometry.setAttribute("color", this.color);
    geometry.setIndex(rectangles.flatMap((_, r) => [0, 1, 2, 1, 3, 2].map((k) => 4 * r + k)));
    this.object = new Mesh(geometry, groundMaterial(strength));
    this.object.receiveShadow = true;
    this.object.position.z = field ? -0.004 : 0;
  }

  use(theme) {
    const grass = new Color(theme.grass);
    for (let i = 0; i < this.color.count; i++) this.color.setXYZ(i, grass.r, grass.g, grass.b);
    this.color.needsUpdate = true;
  }
}
