// The recording: what Rust wrote (data.rs), as arrays, and poses at any time.

const description = JSON.parse(document.getElementById("description").textContent);

function decodeNumbers() {
  const text = atob(document.getElementById("numbers").textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}

function openRecording() {
  const { bodies, steps } = description;
  const buffer = decodeNumbers();
  const times = new Float32Array(buffer, description.times, steps);
  const figures = new Float32Array(buffer, description.figures, 4 * steps);
  const perStep = 7 * bodies.length;
  const unsigned = new Uint16Array(buffer, description.poses, perStep * steps);
  const signed = new Int16Array(buffer, description.poses, perStep * steps);
  const coordinates = (shape) => new Int16Array(buffer, shape.numbers, shape.count);
  const indices = (shape) => new Uint32Array(buffer, shape.triangles, 3 * shape.triangle_count);
  const duration = times[steps - 1];

  // The last step that is not later than `time`.
  function stepAt(time) {
    let low = 0, high = steps - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle; else high = middle - 1;
    }
    return low;
  }

  // Position and rotation (x, y, z, qx, qy, qz, qw) of every body at `time` into `out`; a body that is not there has a
  // rotation of zero. Between steps positions go straight, and rotations the shorter way round.
  function poses(time, out) {
    const step = stepAt(time);
    const next = Math.min(step + 1, steps - 1);
    const length = times[next] - times[step];
    const share = length > 0 ? Math.min(Math.max((time - times[step]) / length, 0), 1) : 0;
    for (let body = 0; body < bodies.length; body++) {
      const from = step * perStep + 7 * body, to = next * perStep + 7 * body;
      const { lower, range } = bodies[body];
      const gone = (at) => !(signed[at + 3] || signed[at + 4] || signed[at + 5] || signed[at + 6]);
      const t = gone(to) ? 0 : share;
      for (let axis = 0; axis < 3; axis++) {
        const number = unsigned[from + axis] * (1 - t) + unsigned[to + axis] * t;
        out[7 * body + axis] = lower[axis] + number / 65535 * range;
      }
      let dot = 0;
      for (let k = 3; k < 7; k++) dot += signed[from + k] * signed[to + k];
      const sign = dot < 0 ? -1 : 1;
      let square = 0;
      for (let k = 3; k < 7; k++) {
        const number = signed[from + k] * (1 - t) + sign * signed[to + k] * t;
        out[7 * body + k] = number;
        square += number * number;
      }
      const scale = gone(from) || square === 0 ? 0 : 1 / Math.sqrt(square);
      for (let k = 3; k < 7; k++) out[7 * body + k] *= scale;
    }
  }

  return { ...description, duration, figures, times, coordinates, indices, stepAt, poses };
}
