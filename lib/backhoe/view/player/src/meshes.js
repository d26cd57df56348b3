// Geometry of the nodes: sharp edges stay sharp, round parts get smooth normals.
import { BufferAttribute, BufferGeometry, Group, Mesh, Vector3 } from "three";
import { machineMaterial } from "./look.js";

const SMOOTH_BELOW = Math.cos((35 * Math.PI) / 180);

export function creased(vertices, faces) {
  const corners = new Float32Array(faces.length * 3);
  const faceNormals = [];
  const around = new Map(); // position -> faces that touch it
  const key = (v) => `${vertices[3 * v]},${vertices[3 * v + 1]},${vertices[3 * v + 2]}`;
  const point = (v) => new Vector3(vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]);
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [point(faces[f]), point(faces[f + 1]), point(faces[f + 2])];
    const area = b.sub(a).cross(c.sub(a));
    faceNormals.push({ area, unit: area.clone().normalize() });
    for (let k = 0; k < 3; k++) {
      const at = key(faces[f + k]);
      if (!around.has(at)) around.set(at, []);
      around.get(at).push(f / 3);
    }
  }
  const normals = new Float32Array(faces.length * 3);
  const sum = new Vector3();
  for (let i = 0; i < faces.length; i++) {
    const own = faceNormals[Math.floor(i / 3)].unit;
    sum.set(0, 0, 0);
    for (const other of around.get(key(faces[i]))) {
      if (faceNormals[other].unit.dot(own) > SMOOTH_BELOW) sum.add(faceNormals[other].area);
    }
    sum.normalize().toArray(normals, 3 * i);
    corners.set(vertices.subarray(3 * faces[i], 3 * faces[i] + 3), 3 * i);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setAttribute("normal", new BufferAttribute(normals, 3));
  return geometry;
}

// a mesh whose vertices follow a scalar
class Morph {
  constructor(mesh, scalar) {
    this.shapes = mesh.vertices;
    this.knots = mesh.knots;
    this.values = scalar.values;
    this.size = mesh.vertices.length / mesh.knots.length;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(this.shapes.slice(0, this.size), 3));
    geometry.setIndex(new BufferAttribute(mesh.faces, 1));
    this.object = new Mesh(geometry, machineMaterial(mesh.colour));
    this.object.frustumCulled = false;
  }

  show(frame) {
    const a = Math.floor(frame), b = Math.min(a + 1, this.values.length - 1);
    const value = this.values[a] + (frame - a) * (this.values[b] - this.values[a]);
    const { knots, shapes, size } = this;
    let k = 0;
    while (k < knots.length - 2 && value > knots[k + 1]) k++;
    const share = Math.min(1, Math.max(0, (value - knots[k]) / (knots[k + 1] - knots[k])));
    const position = this.object.geometry.attributes.position;
    for (let i = 0; i < size; i++) {
      const from = shapes[k * size + i];
      position.array[i] = from + share * (shapes[(k + 1) * size + i] - from);
    }
    position.needsUpdate = true;
    this.object.geometry.computeVertexNormals();
    this.object.visible = value > knots[0] + 2e-3;
  }
}

export function buildNodes(recording, scene) {
  const morphs = [];
  const groups = recording.nodes.map((node) => {
    const group = new Group();
    group.matrixAutoUpdate = false;
    for (const mesh of node.meshes) {
      let object;
      if (mesh.knots) {
        const morph = new Morph(mesh, recording.scalars.find((s) => s.name === mesh.scalar));
        morphs.push(morph);
        object = morph.object;
      } else {
        object = new Mesh(creased(mesh.vertices, mesh.faces), machineMaterial(mesh.colour));
      }
      object.castShadow = object.receiveShadow = true;
      group.add(object);
    }
    scene.add(group);
    return group;
  });
  return { groups, morphs };
}
