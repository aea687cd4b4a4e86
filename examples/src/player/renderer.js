// Draws the scene: shadows first, then solid things, then what can be seen through.

const BACKGROUND = [0.902, 0.914, 0.925];
const LIGHT = normalize([-0.45, 1.0, 0.35]);
const SHADOW_SIZE = 2048;
// Floats per instance of a mesh: place and size, rotation, colour.
const INSTANCE = 12;

function createRenderer(canvas, recording) {
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
  if (!gl) return null;
  const solid = program(MESH_VERTEX, MESH_FRAGMENT), solidDepth = program(MESH_VERTEX, MESH_DEPTH);
  const ball = program(BALL_VERTEX, BALL_FRAGMENT), ballDepth = program(BALL_VERTEX, BALL_DEPTH);
  const floor = program(GROUND_VERTEX, GROUND_FRAGMENT);
  const square = buffer(new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]));
  const floorArray = vertexArray(() => attribute(square, 0, 2, 0, 0));
  const meshes = recording.meshes.map(meshOnCard);
  const packings = recording.packings.map(packingOnCard);
  const colors = recording.bodies.map(({ color: [r, g, b, a] }) => [r ** 2.2, g ** 2.2, b ** 2.2, a]);
  const poses = new Float32Array(7 * recording.bodies.length);
  const { target: shadowTarget, texture: shadowTexture } = shadowMap();
  const extent = recording.radius;
  // The lamp sees twice the extent: things fall in from above.
  const reach = 2.2 * extent;
  const lamp = add(recording.center, LIGHT, 3 * reach);
  const lightProjection = multiply(
    orthographic(reach, 0.5 * reach, 5.5 * reach), lookAt(lamp, recording.center, [0, 0, 1]));

  function program(vertex, fragment) {
    const linked = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(linked, shader);
    }
    gl.linkProgram(linked);
    if (!gl.getProgramParameter(linked, gl.LINK_STATUS)) {
      const logs = gl.getAttachedShaders(linked).map((shader) => gl.getShaderInfoLog(shader));
      throw new Error(gl.getProgramInfoLog(linked) + logs.join(""));
    }
    const uniforms = {};
    const count = gl.getProgramParameter(linked, gl.ACTIVE_UNIFORMS);
    for (let i = 0; i < count; i++) {
      const { name } = gl.getActiveUniform(linked, i);
      uniforms[name] = gl.getUniformLocation(linked, name);
    }
    return { linked, uniforms };
  }

  function buffer(data) {
    const created = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, created);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    return created;
  }

  function vertexArray(describe) {
    const created = gl.createVertexArray();
    gl.bindVertexArray(created);
    describe();
    gl.bindVertexArray(null);
    return created;
  }

  // Floats `offset` to `offset + size` of every `stride`; `divisor` 1 for one value per instance.
  function attribute(from, location, size, stride, offset, divisor = 0) {
    gl.bindBuffer(gl.ARRAY_BUFFER, from);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, 4 * stride, 4 * offset);
    gl.vertexAttribDivisor(location, divisor);
  }

  function meshOnCard(shape) {
    const data = corners(recording.coordinates(shape), recording.indices(shape));
    const vertices = buffer(data), instances = gl.createBuffer();
    const array = vertexArray(() => {
      attribute(vertices, 0, 3, 6, 0);
      attribute(vertices, 1, 3, 6, 3);
      [0, 4, 8].forEach((offset, i) => attribute(instances, 2 + i, 4, INSTANCE, offset, 1));
    });
    return { array, instances, count: data.length / 6, solid: [], clear: [] };
  }

  function packingOnCard(shape) {
    const balls = buffer(Float32Array.from(recording.coordinates(shape), (number) => number / 32767));
    const array = vertexArray(() => {
      attribute(square, 0, 2, 0, 0);
      attribute(balls, 1, 4, 4, 0, 1);
    });
    return { array, count: shape.count / 4 };
  }

  function shadowMap() {
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW_SIZE, SHADOW_SIZE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    const target = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return { target, texture };
  }

  // Where the shape of a body is: centre and size, rotation.
  function placed(body, { center, size }) {
    const at = 7 * body;
    const [x, y, z] = add(poses.subarray(at, at + 3), rotate(poses, at + 3, center));
    return [x, y, z, size];
  }

  const isThere = (body) => poses[7 * body + 6] !== 0 || poses[7 * body + 3] !== 0
    || poses[7 * body + 4] !== 0 || poses[7 * body + 5] !== 0;

  // Sorts the bodies into instances of meshes, solid and clear, and balls.
  function arrange(showSpheres) {
    for (const mesh of meshes) { mesh.solid = []; mesh.clear = []; }
    const balls = [];
    recording.bodies.forEach((body, index) => {
      if (!isThere(index)) return;
      const rotation = poses.subarray(7 * index + 3, 7 * index + 7);
      if (body.spheres && (showSpheres || !body.mesh)) {
        balls.push({ packing: packings[body.spheres.shape], place: placed(index, body.spheres), rotation, color: colors[index] });
      } else if (body.mesh) {
        const mesh = meshes[body.mesh.shape], color = colors[index];
        const list = color[3] < 0.99 ? mesh.clear : mesh.solid;
        list.push(...placed(index, body.mesh), ...rotation, ...color);
      }
    });
    return balls;
  }

  function drawMeshes(list) {
    for (const mesh of meshes) {
      if (mesh[list].length === 0) continue;
      gl.bindVertexArray(mesh.array);
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.instances);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(mesh[list]), gl.DYNAMIC_DRAW);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, mesh.count, mesh[list].length / INSTANCE);
    }
  }

  function drawBalls(balls, { uniforms }) {
    for (const { packing, place, rotation, color } of balls) {
      gl.uniform4fv(uniforms.place, place);
      gl.uniform4fv(uniforms.rotation, rotation);
      if (uniforms.tint) gl.uniform4fv(uniforms.tint, color);
      gl.bindVertexArray(packing.array);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, packing.count);
    }
  }

  // Makes `used` the program; `view` has the projection and the eye.
  function use(used, view) {
    const { linked, uniforms } = used;
    gl.useProgram(linked);
    gl.uniformMatrix4fv(uniforms.viewProjection, false, view.projection);
    const set = (name, value) => { if (uniforms[name]) gl["uniform" + (value.length || 1) + (value.length ? "fv" : "f")](uniforms[name], value); };
    set("eye", view.eye);
    set("light", LIGHT);
    set("ground", recording.ground);
    set("extent", extent);
    set("middle", recording.center);
    set("background", BACKGROUND);
    if (uniforms.parallel) gl.uniform1i(uniforms.parallel, view.parallel ? 1 : 0);
    if (uniforms.lightProjection) gl.uniformMatrix4fv(uniforms.lightProjection, false, lightProjection);
    if (uniforms.shadowMap) gl.uniform1i(uniforms.shadowMap, 0);
    return used;
  }

  function drawShadows(balls) {
    const view = { projection: lightProjection, eye: lamp, parallel: true };
    gl.bindTexture(gl.TEXTURE_2D, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, shadowTarget);
    gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    use(solidDepth, view);
    drawMeshes("solid");
    drawBalls(balls, use(ballDepth, view));
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.bindTexture(gl.TEXTURE_2D, shadowTexture);
  }

  // What can be seen through: far sides first, then near ones.
  function drawClear(view) {
    use(solid, view);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    gl.enable(gl.CULL_FACE);
    for (const side of [gl.FRONT, gl.BACK]) {
      gl.cullFace(side);
      drawMeshes("clear");
    }
    gl.disable(gl.CULL_FACE);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  function draw(time, view, showSpheres) {
    recording.poses(time, poses);
    const balls = arrange(showSpheres);
    gl.enable(gl.DEPTH_TEST);
    drawShadows(balls);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...BACKGROUND, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    use(floor, view);
    gl.bindVertexArray(floorArray);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    use(solid, view);
    drawMeshes("solid");
    drawBalls(balls, use(ball, view));
    drawClear(view);
  }

  return { draw };
}
