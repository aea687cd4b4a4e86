// Programs for the graphics card.

const HEAD = `#version 300 es
precision highp float;
precision highp sampler2DShadow;
uniform mat4 viewProjection;
uniform vec3 eye;
uniform vec3 light;
`;

const TURN = `
vec3 turn(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
`;

// Light of one distant lamp with soft shadows, of a bright sky and of a darker ground.
const SHADE = `
uniform mat4 lightProjection;
uniform sampler2DShadow shadowMap;
uniform float ground;
uniform float extent;
out vec4 pixel;

float lit(vec3 p, vec3 n) {
  vec3 s = (lightProjection * vec4(p + n * extent * 0.006, 1.0)).xyz * 0.5 + 0.5;
  if (any(lessThan(s, vec3(0.0))) || any(greaterThan(s, vec3(1.0)))) return 1.0;
  float sum = 0.0;
  for (int i = -2; i <= 2; i++)
    for (int j = -2; j <= 2; j++)
      sum += texture(shadowMap, vec3(s.xy + vec2(i, j) * 1.3 / 2048.0, s.z - 0.0006));
  return sum / 25.0;
}

vec3 shade(vec3 albedo, vec3 n, vec3 p) {
  vec3 v = normalize(eye - p);
  float shadow = lit(p, n);
  float key = max(dot(n, light), 0.0) * shadow;
  float near = mix(0.62, 1.0, smoothstep(0.0, 0.35 * extent, p.y - ground + 0.05 * extent));
  vec3 sky = mix(vec3(0.30, 0.28, 0.26), vec3(0.52, 0.57, 0.63), 0.5 + 0.5 * n.y) * near;
  float gloss = pow(max(dot(n, normalize(light + v)), 0.0), 50.0) * 0.16 * shadow;
  float rim = pow(1.0 - max(dot(n, v), 0.0), 3.0) * 0.07;
  return albedo * (sky + 1.05 * key * vec3(1.0, 0.97, 0.92)) + gloss + rim;
}

vec3 display(vec3 c) { return pow(clamp(c / (1.0 + 0.12 * c), 0.0, 1.0), vec3(1.0 / 2.2)); }
`;

const MESH_VERTEX = HEAD + TURN + `
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 place;
layout(location = 3) in vec4 rotation;
layout(location = 4) in vec4 tint;
out vec3 world;
out vec3 direction;
out vec4 color;
void main() {
  world = turn(rotation, position * place.w) + place.xyz;
  direction = turn(rotation, normal);
  color = tint;
  gl_Position = viewProjection * vec4(world, 1.0);
}`;

const MESH_FRAGMENT = HEAD + SHADE + `
in vec3 world;
in vec3 direction;
in vec4 color;
void main() {
  vec3 n = normalize(direction);
  if (!gl_FrontFacing) n = -n;
  pixel = vec4(display(shade(color.rgb, n, world)), color.a);
}`;

// A ball is a square that faces the eye and just covers it; the ray through each pixel is met with the ball.
const BALL_VERTEX = HEAD + TURN + `
layout(location = 0) in vec2 corner;
layout(location = 1) in vec4 ball;
uniform vec4 place;
uniform vec4 rotation;
uniform bool parallel;
out vec3 world;
flat out vec3 center;
flat out float radius;
void main() {
  center = turn(rotation, ball.xyz * place.w) + place.xyz;
  radius = ball.w * place.w;
  vec3 away = parallel ? -light : center - eye;
  float distance = length(away);
  vec3 z = away / distance;
  vec3 x = normalize(cross(z, abs(z.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  vec3 y = cross(x, z);
  float larger = parallel ? 1.0 : distance / sqrt(max(distance * distance - radius * radius, 1e-4 * distance * distance));
  world = center + (x * corner.x + y * corner.y) * radius * larger;
  gl_Position = viewProjection * vec4(world, 1.0);
}`;

const MEET = `
in vec3 world;
flat in vec3 center;
flat in float radius;
uniform bool parallel;
vec3 meet() {
  vec3 ray = parallel ? -light : normalize(world - eye);
  vec3 from = parallel ? world - ray * 2.0 * radius : eye;
  vec3 to = from - center;
  float half_b = dot(to, ray);
  float root = half_b * half_b - dot(to, to) + radius * radius;
  if (root < 0.0) discard;
  vec3 p = from + ray * (-half_b - sqrt(root));
  vec4 clip = viewProjection * vec4(p, 1.0);
  gl_FragDepth = clip.z / clip.w * 0.5 + 0.5;
  return p;
}
`;

const BALL_FRAGMENT = HEAD + SHADE + MEET + `
uniform vec4 tint;
void main() {
  vec3 p = meet();
  pixel = vec4(display(shade(tint.rgb, normalize(p - center), p)), 1.0);
}`;

const BALL_DEPTH = HEAD + MEET + `void main() { meet(); }`;
const MESH_DEPTH = HEAD + `void main() {}`;

const GROUND_VERTEX = HEAD + `
layout(location = 0) in vec2 corner;
uniform float ground;
uniform float extent;
uniform vec3 middle;
out vec3 world;
void main() {
  world = vec3(middle.x + corner.x * 14.0 * extent, ground - 0.002 * extent, middle.z + corner.y * 14.0 * extent);
  gl_Position = viewProjection * vec4(world, 1.0);
}`;

const GROUND_FRAGMENT = HEAD + SHADE + `
uniform vec3 middle;
uniform vec3 background;
in vec3 world;
void main() {
  float shadow = lit(world, vec3(0.0, 1.0, 0.0));
  float distance = length(world.xz - middle.xz) / extent;
  float near = 1.0 - smoothstep(0.4, 7.0, distance);
  vec3 floor_color = mix(background, background * 1.06, near) * mix(0.72, 1.0, shadow);
  pixel = vec4(mix(background, floor_color, 1.0 - smoothstep(3.0, 10.0, distance)), 1.0);
}`;
