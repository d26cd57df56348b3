// Where every node is at a (fractional) frame.
import { Matrix4, Quaternion, Vector3 } from "three";

const matrix = (rows) => new Matrix4().set(...rows, 0, 0, 0, 1);
const zAxis = new Vector3(0, 0, 1);

export class Motion {
  constructor(nodes) {
    this.nodes = nodes.map((node) => ({
      parent: node.parent,
      kind: node.motion,
      values: node.values,
      before: matrix(node.before),
      after: matrix(node.after),
      world: new Matrix4(),
    }));
  }

  pose(frame) {
    const a = Math.floor(frame);
    for (const node of this.nodes) {
      node.world.copy(node.before);
      if (node.kind !== "fixed") node.world.multiply(moved(node, a, frame - a));
      node.world.multiply(node.after);
      if (node.parent >= 0) node.world.premultiply(this.nodes[node.parent].world);
    }
  }

  // path of a node's origin over all frames, as x, y, z, x, y, z ...
  path(index, frames) {
    const points = new Float32Array(3 * frames);
    for (let frame = 0; frame < frames; frame++) {
      this.pose(frame);
      points.set(this.nodes[index].world.elements.slice(12, 15), 3 * frame);
    }
    return points;
  }
}

const joint = new Matrix4();
const at = new Vector3();
const turn = new Quaternion();
const one = new Vector3(1, 1, 1);

function moved({ kind, values }, a, share) {
  const columns = { revolute: 1, planar: 3, free: 7 }[kind];
  const b = Math.min(a + 1, values.length / columns - 1);
  const value = (c) => {
    const from = values[a * columns + c];
    return from + share * (values[b * columns + c] - from);
  };
  if (kind === "revolute") return joint.makeRotationZ(value(0));
  if (kind === "planar") {
    return joint.compose(at.set(value(0), value(1), 0), turn.setFromAxisAngle(zAxis, value(2)), one);
  }
  turn.set(value(3), value(4), value(5), value(6)).normalize();
  return joint.compose(at.set(value(0), value(1), value(2)), turn, one);
}
