// Shaders: place and colour the points, then shade edges by depth.

/** Which points are drawn, and how large. */
const POINT_HEAD = /* glsl */ `
precision highp float;
uniform mat4 modelMatrix;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform vec3 eye;
uniform float size;
uniform float height_px;
uniform float parallel_m;
uniform vec3 box_low;
uniform vec3 box_high;
uniform vec4 section;
uniform float section_half_m;
uniform float until_s;
uniform bool cutaway;
uniform float ceiling_m;
in vec3 position;
in float intensity;
in float ring;
in float time;
in float sd;
in float distance_m;

void place() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * seen;
  // Points grow towards the camera, so that near surfaces look closed; in a parallel view by its width.
  float away = parallel_m > 0.0 ? parallel_m : -seen.z;
  gl_PointSize = clamp(size * height_px * 0.012 / away, size, 4.0 * size);
  // The other cloud of a comparison may have another origin.
  vec3 world = (modelMatrix * vec4(position, 1.0)).xyz;
  // Every surface faces the scanner at the origin: a surface whose back faces the camera hides the interior.
  bool hidden = cutaway && world.z > -0.5 && dot(normalize(-world), normalize(eye - world)) < -0.1;
  hidden = hidden || (cutaway && world.z > ceiling_m && eye.z > ceiling_m);
  hidden = hidden || any(lessThan(world, box_low)) || any(greaterThan(world, box_high));
  hidden = hidden || abs(dot(section.xyz, world) - section.w) > section_half_m || time > until_s;
  if (hidden) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

/** `field`: 0 height, 1 range, 2 intensity, 3 ring, 4 time, 5 uncertainty, 6 distance from another cloud. */
export const POINT_VERTEX = `${POINT_HEAD}
uniform int field;
uniform vec2 limits;
uniform vec4 below;
uniform vec4 above;
uniform highp sampler2D colours;
flat out vec3 colour;

void main() {
  place();
  float value = field == 0 ? position.z : field == 1 ? length(position) : field == 2 ? intensity : field == 3 ? ring : field == 4 ? time : field == 5 ? sd : distance_m;
  float share = (value - limits.x) / (limits.y - limits.x);
  colour = texture(colours, vec2((clamp(share, 0.0, 1.0) * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  // The fourth number says whether there is such a colour.
  if (share < 0.0) colour = mix(colour, below.rgb, below.a);
  if (share > 1.0) colour = mix(colour, above.rgb, above.a);
}`;

/** All points in one colour. */
export const PLAIN_VERTEX = `${POINT_HEAD}
uniform vec3 ink;
flat out vec3 colour;

void main() {
  place();
  colour = ink;
}`;

/** Writes the values of points instead of colours: position and time; uncertainty, tilt and the whole numbers; distance. */
export const PICK_VERTEX = `${POINT_HEAD}
in float tilt;
in float laser;
in float echo;
flat out uvec4 place_time;
flat out uvec4 others;
flat out uvec4 distances;

void main() {
  place();
  place_time = floatBitsToUint(vec4(position, time));
  // The highest bit marks a hit.
  others = uvec4(floatBitsToUint(vec3(sd, tilt, intensity)), 0x80000000u | (uint(laser) << 16) | (uint(echo) << 8) | uint(ring));
  distances = uvec4(floatBitsToUint(distance_m), 0u, 0u, 0u);
}`;

export const PICK_FRAGMENT = /* glsl */ `
precision highp float;
precision highp int;
flat in uvec4 place_time;
flat in uvec4 others;
flat in uvec4 distances;
layout(location = 0) out uvec4 first;
layout(location = 1) out uvec4 second;
layout(location = 2) out uvec4 third;

void main() {
  vec2 off = gl_PointCoord - 0.5;
  if (dot(off, off) > 0.27) discard;
  first = place_time;
  second = others;
  third = distances;
}`;

export const POINT_FRAGMENT = /* glsl */ `
precision mediump float;
flat in vec3 colour;
out vec4 pixel;

void main() {
  vec2 off = gl_PointCoord - 0.5;
  if (dot(off, off) > 0.27) discard;
  pixel = vec4(colour, 1.0);
}`;

export const LINE_VERTEX = /* glsl */ `
precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
in vec3 position;

void main() {
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const LINE_FRAGMENT = /* glsl */ `
precision mediump float;
uniform vec3 ink;
out vec4 pixel;

void main() {
  pixel = vec4(ink, 1.0);
}`;

export const SCREEN_VERTEX = /* glsl */ `
in vec3 position;
out vec2 at;

void main() {
  at = position.xy * 0.5 + 0.5;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

/** Eye-dome lighting (Boucheny 2009): a pixel is darker the farther it is behind its neighbours. */
export const SCREEN_FRAGMENT = /* glsl */ `
precision highp float;
uniform highp sampler2D picture;
uniform highp sampler2D depth;
uniform vec2 pixel_size;
uniform vec2 clip;
uniform float strength;
uniform float parallel_m;
in vec2 at;
out vec4 pixel;

float distance_log2(vec2 where) {
  float d = texture(depth, where).r;
  if (d >= 1.0) return -1e9;
  // In a parallel view depth is linear: relative to the distance, as the logarithm is at the target.
  if (parallel_m > 0.0) return 1.44 * (clip.x + d * (clip.y - clip.x)) / parallel_m;
  return log2(clip.x * clip.y / (clip.y - d * (clip.y - clip.x)));
}

void main() {
  vec4 colour = texture(picture, at);
  float here = distance_log2(at);
  float behind = 0.0;
  for (int i = 0; i < 8; i++) {
    float turn = float(i) * 0.7853981634;
    float there = distance_log2(at + 1.4 * pixel_size * vec2(cos(turn), sin(turn)));
    if (there < -1e8) continue;
    // Only points are shaded, not the background next to them.
    behind += here < -1e8 ? 0.0 : max(0.0, here - there);
  }
  pixel = vec4(colour.rgb * exp(-strength * behind / 8.0), 1.0);
}`;
