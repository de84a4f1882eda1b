// Shaders: place and colour the points, then shade edges by depth.

/** `field`: 0 height, 1 intensity, 2 ring, 3 time, 4 uncertainty. */
export const POINT_VERTEX = /* glsl */ `
precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform vec3 eye;
uniform float size;
uniform float height_px;
uniform int field;
uniform vec2 range;
uniform float below_m;
uniform bool cutaway;
uniform float ceiling_m;
uniform highp sampler2D colours;
in vec3 position;
in float intensity;
in float ring;
in float time;
in float sd;
flat out vec3 colour;

void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * seen;
  // Points grow towards the camera, so that near surfaces look closed.
  gl_PointSize = clamp(size * height_px * 0.012 / -seen.z, size, 4.0 * size);
  // Every surface faces the scanner at the origin: a surface whose back faces the camera hides the interior.
  bool back = cutaway && position.z > -0.5 && dot(normalize(-position), normalize(eye - position)) < -0.1;
  back = back || (cutaway && position.z > ceiling_m && eye.z > ceiling_m);
  if (back || position.z > below_m) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  float value = field == 0 ? position.z : field == 1 ? intensity : field == 2 ? ring : field == 3 ? time : sd;
  float share = clamp((value - range.x) / (range.y - range.x), 0.0, 1.0);
  colour = texture(colours, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
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
in vec2 at;
out vec4 pixel;

float distance_log2(vec2 where) {
  float d = texture(depth, where).r;
  if (d >= 1.0) return -1.0;
  return log2(clip.x * clip.y / (clip.y - d * (clip.y - clip.x)));
}

void main() {
  vec4 colour = texture(picture, at);
  float here = distance_log2(at);
  float behind = 0.0;
  for (int i = 0; i < 8; i++) {
    float turn = float(i) * 0.7853981634;
    float there = distance_log2(at + 1.4 * pixel_size * vec2(cos(turn), sin(turn)));
    if (there < 0.0) continue;
    // Only points are shaded, not the background next to them.
    behind += here < 0.0 ? 0.0 : max(0.0, here - there);
  }
  pixel = vec4(colour.rgb * exp(-strength * behind / 8.0), 1.0);
}`;
