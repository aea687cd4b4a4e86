// Vectors, matrices in columns, and corners of meshes with normals.

const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const add = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const normalize = (a) => { const length = Math.hypot(...a) || 1; return [a[0] / length, a[1] / length, a[2] / length]; };

// `v` turned by the quaternion at `offset` of `q`.
function rotate(q, offset, v) {
  const axis = [q[offset], q[offset + 1], q[offset + 2]], w = q[offset + 3];
  return add(v, cross(axis, add(cross(axis, v), v, w)), 2);
}

function multiply(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      out[4 * column + row] = sum;
    }
  }
  return out;
}

function lookAt(eye, target, up) {
  const z = normalize(subtract(eye, target)), x = normalize(cross(up, z)), y = cross(z, x);
  return new Float32Array([
    x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1,
  ]);
}

function perspective(fieldOfView, aspect, near, far) {
  const f = 1 / Math.tan(fieldOfView / 2);
  return new Float32Array([
    f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0,
  ]);
}

function orthographic(half, near, far) {
  return new Float32Array([
    1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, 2 / (near - far), 0, 0, 0, (far + near) / (near - far), 1,
  ]);
}

// Faces that meet at a smaller angle share their normals, as in the pictures (render/mesh.rs).
const CREASE = Math.cos(40 * Math.PI / 180);

// Position and normal of each corner of each triangle, one after the other. A corner's normal is that of the faces around
// it that turn less than the crease angle from its own, weighted by area.
function corners(coordinates, indices) {
  const point = (index) => {
    const at = 3 * index;
    return [coordinates[at] / 32767, coordinates[at + 1] / 32767, coordinates[at + 2] / 32767];
  };
  const faces = [], around = new Map();
  for (let face = 0; 3 * face < indices.length; face++) {
    const [a, b, c] = [0, 1, 2].map((corner) => point(indices[3 * face + corner]));
    const area = cross(subtract(b, a), subtract(c, a));
    faces.push({ area, normal: normalize(area) });
    for (let corner = 0; corner < 3; corner++) {
      const vertex = indices[3 * face + corner];
      if (!around.has(vertex)) around.set(vertex, []);
      around.get(vertex).push(face);
    }
  }
  const out = new Float32Array(6 * indices.length);
  indices.forEach((vertex, corner) => {
    const own = faces[Math.floor(corner / 3)];
    let sum = [0, 0, 0];
    for (const face of around.get(vertex)) {
      if (dot(faces[face].normal, own.normal) >= CREASE) sum = add(sum, faces[face].area);
    }
    out.set(point(vertex), 6 * corner);
    out.set(normalize(sum), 6 * corner + 3);
  });
  return out;
}
