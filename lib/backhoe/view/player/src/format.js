// Reads the file that backhoe/replay/recording_file.py writes.

function unpack(bytes, order) {
  const values = [];
  for (let at = 0; at < bytes.length; ) {
    let zigzag = 0, place = 1, byte;
    do {
      byte = bytes[at++];
      zigzag += (byte & 127) * place;
      place *= 128;
    } while (byte > 127);
    values.push(zigzag % 2 ? -(zigzag + 1) / 2 : zigzag / 2);
  }
  for (; order > 0; order--) {
    for (let i = 1; i < values.length; i++) values[i] += values[i - 1];
  }
  return values;
}

export function decode(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  let at = 4 + length;
  const sections = header.sections.map((size) => {
    const section = new Uint8Array(buffer, at, size);
    at += size;
    return section;
  });
  const integers = (index, order = 0) => unpack(sections[index], order);

  // columns of numbers, interleaved: row r, column c at [r * columns + c]
  const steps = (entry) => {
    const columns = entry.sections.map((index) => integers(index, entry.order));
    const values = new Float64Array(columns.length * columns[0].length);
    columns.forEach((column, c) => {
      column.forEach((value, r) => (values[r * columns.length + c] = value * entry.steps[c]));
    });
    return values;
  };

  header.times = steps(header.times);
  for (const node of header.nodes) {
    if (node.values) node.values = steps(node.values);
    for (const mesh of node.meshes) {
      mesh.vertices = Float32Array.from(steps(mesh.vertices));
      mesh.faces = Uint32Array.from(integers(mesh.faces, 1));
    }
  }
  for (const scalar of header.scalars) scalar.values = steps(scalar.values);
  for (const line of header.lines) line.points = Float32Array.from(steps(line.points));
  for (const field of header.fields) {
    field.first = Int32Array.from(integers(field.first, 1));
    field.counts = integers(field.counts);
    field.gaps = integers(field.gaps);
    field.deltas = integers(field.deltas);
  }
  return header;
}
