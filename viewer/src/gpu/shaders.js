/**
 * What the GPU computes. Buffers of floats have the screen's rows from above; all places are in pixels of a tile of the
 * file, so that numbers stay small. docs/format.md, "Drawing", says what a picture is: a sum of three parts.
 */

const COMMON = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
uniform vec2 size; // of what is drawn to
uniform vec2 start; // the tile's point at the screen's upper left corner
uniform float scale; // screen pixels for each of the tile's
uniform vec2 extent; // of the tile
uniform vec4 fades; // at its left, upper, right, lower end: how wide it fades into the next tile; -1: there is none

vec4 place(vec2 pixel) { return vec4(pixel / size * 2.0 - 1.0, 0, 1); }

float edge(float inside, float width, bool holds) {
  if (width < 0.0) return 1.0;
  return width > 0.0 ? clamp(inside / width, 0.0, 1.0) : float(inside > 0.0 || (holds && inside == 0.0));
}

// The tile's share of what is seen at one of its points.
float share(vec2 at) {
  vec2 behind = extent - at;
  float first = edge(at.x, fades.x, true) * edge(at.y, fades.y, true);
  return first * edge(behind.x, fades.z, false) * edge(behind.y, fades.w, false);
}

vec4 listed(sampler2D list, int index) { return texelFetch(list, ivec2(index & 1023, index >> 10), 0); }
`;

/** A Gaussian at this scale: the triangle L of its covariance, widened by what a pixel covers beyond the picture's. */
const GAUSSIAN = `${COMMON}
uniform float wider; // variance, screen pixels
layout(location = 0) in vec2 corner;
layout(location = 1) in vec2 mean;
layout(location = 2) in vec3 triangle;
layout(location = 3) in vec3 colour;
flat out vec2 centre;
flat out vec3 inverse;
flat out vec3 shown;

void main() {
  vec3 l = triangle * scale;
  float xx = l.x * l.x, yx = l.x * l.y, yy = l.y * l.y + l.z * l.z;
  float before = l.x * l.z;
  float after = sqrt(before * before + wider * (xx + yy + wider));
  l.x = sqrt(xx + wider);
  l.y = yx / l.x;
  l.z = after / l.x;
  centre = (mean - start) * scale;
  inverse = vec3(1.0 / l.x, l.y / l.x, 1.0 / l.z);
  shown = colour * (before / after);
  vec2 q = corner * 3.5;
  gl_Position = place(centre + vec2(l.x * q.x, l.y * q.x + l.z * q.y));
}`;

const GAUSSIAN_PIXEL = `${COMMON}
flat in vec2 centre;
flat in vec3 inverse;
flat in vec3 shown;
out vec4 sum;

void main() {
  vec2 d = gl_FragCoord.xy - centre;
  vec2 q = vec2(d.x * inverse.x, (d.y - d.x * inverse.y) * inverse.z);
  float squared = dot(q, q);
  if (squared > 12.25) discard; // the rasteriser's cutoff of 3.5 deviations
  sum = vec4(shown * exp(-0.5 * squared) * share(start + gl_FragCoord.xy / scale), 0);
}`;

/** The base layer: cubic between its cells, the mean of a few samples where a pixel covers much of one. Alpha: share. */
const BASE = `${COMMON}
layout(location = 0) in vec2 corner;

void main() {
  vec2 middle = 0.5 * extent;
  gl_Position = place((middle + corner * middle - start) * scale + corner);
}`;

const BASE_PIXEL = `${COMMON}
uniform sampler2D cells;
uniform ivec2 grid;
uniform float side;
uniform int samples;
out vec4 sum;

vec4 cubic(float f) {
  vec4 d = vec4(1.0 + f, f, 1.0 - f, 2.0 - f);
  vec4 near = (1.5 * d - 2.5) * d * d + 1.0, far = ((-0.5 * d + 2.5) * d - 4.0) * d + 2.0;
  return vec4(far.x, near.y, near.z, far.w);
}

vec3 base(vec2 at) {
  vec2 cell = at / side - 0.5, low = floor(cell);
  vec4 across = cubic(cell.x - low.x), down = cubic(cell.y - low.y);
  vec3 colour = vec3(0);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      ivec2 place = clamp(ivec2(low) + ivec2(x, y) - 1, ivec2(0), grid - 1);
      colour += listed(cells, place.y * grid.x + place.x).rgb * (across[x] * down[y]);
    }
  }
  return colour;
}

void main() {
  vec3 colour = vec3(0);
  vec2 pixel = gl_FragCoord.xy - 0.5;
  for (int i = 0; i < samples * samples; ++i) {
    vec2 inside = (vec2(i % samples, i / samples) + 0.5) / float(samples);
    colour += base(start + (pixel + inside) / scale);
  }
  float part = share(start + gl_FragCoord.xy / scale);
  sum = vec4(colour * (part / float(max(1, samples * samples))), part);
}`;

/**
 * Texture, first half: for each cell that is seen a strip in a buffer. Its left part has, for each row of amplitudes and
 * each column of pixels, the sum of the row's atoms; its right part the atoms down the pixels' rows.
 */
const STRIP_VERTEX = `
layout(location = 0) in vec2 corner;
layout(location = 1) in vec4 slot; // where the strip is: x, y, columns and rows of pixels
layout(location = 2) in vec4 seen; // first column and row of pixels; rows of amplitudes, the first of them
layout(location = 3) in vec4 cell; // corner, width, height
flat out ivec4 strip;
flat out ivec4 pixels;
flat out vec4 box;
void send() { strip = ivec4(slot); pixels = ivec4(seen); box = cell; }
`;

const ROWS = `${COMMON}${STRIP_VERTEX}
void main() {
  send();
  gl_Position = place(slot.xy + (corner * 0.5 + 0.5) * vec2(slot.z + slot.w, seen.z));
}`;

const ROWS_PIXEL = `${COMMON}
uniform sampler2D rows;
uniform sampler2D atoms;
uniform vec2 gridEnd; // of the cells
uniform vec3 blur; // of a pixel larger than the picture's: deviation, distance of its samples, samples on each side
flat in ivec4 strip;
flat in ivec4 pixels;
flat in vec4 box;
out vec4 sum;
const float OVERLAP = 4.0;

float rise(float t, bool hard) {
  if (hard) return step(0.0, t);
  return sin(0.7853981634 * (1.0 + clamp(t / OVERLAP, -1.0, 1.0)));
}

float weight(float offset) { return blur.x > 0.0 ? exp(-0.5 * (offset / blur.x) * (offset / blur.x)) : 1.0; }

vec2 between(float middle, float low, float high) {
  return vec2(max(-blur.z, ceil((low - middle) / blur.y)), min(blur.z, floor((high - middle) / blur.y)));
}

float wave(float frequency, float t, float side) { return cos(6.283185307 * fract((frequency + 0.5) * t / (2.0 * side))); }

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) - strip.xy;
  bool across = at.x < strip.z;
  float pixel = across ? float(pixels.x + at.x) : float(pixels.y + at.x - strip.z);
  float begin = across ? box.x : box.y, side = across ? box.z : box.w, end = across ? gridEnd.x : gridEnd.y;
  float middle = (across ? start.x : start.y) + (pixel + 0.5) / scale;
  bvec2 hard = bvec2(begin == 0.0, begin + side == end);
  vec4 row = listed(rows, pixels.w + at.y); // frequency down, first atom, atoms
  vec2 inside = vec2(0);
  if (blur.x > 0.0)
    inside = between(middle, begin - (hard.x ? 0.0 : OVERLAP), begin + side + (hard.y ? 0.0 : OVERLAP));
  sum = vec4(0);
  for (float node = inside.x; node <= inside.y; ++node) {
    float t = middle + node * blur.y - begin;
    float window = rise(t, hard.x) * rise(side - t, hard.y) * weight(node * blur.y);
    if (across) {
      for (int i = 0; i < int(row.z); ++i) {
        vec4 atom = listed(atoms, int(row.y) + i);
        sum.rgb += atom.rgb * (window * wave(atom.w, t, side));
      }
    } else {
      sum.r += window * wave(row.x, t, side);
    }
  }
  float total = 1.0;
  if (blur.x > 0.0) {
    total = 0.0;
    vec2 all = between(middle, 0.0, end);
    for (float node = all.x; node <= all.y; ++node) total += weight(node * blur.y);
  }
  sum *= sqrt(2.0 / side) / total;
}`;

/** Second half: each pixel of a cell adds up the products of its column and its row. */
const CELL = `${COMMON}${STRIP_VERTEX}
void main() {
  send();
  gl_Position = place(seen.xy + (corner * 0.5 + 0.5) * slot.zw);
}`;

const CELL_PIXEL = `${COMMON}
uniform sampler2D strips;
flat in ivec4 strip;
flat in ivec4 pixels;
flat in vec4 box;
out vec4 sum;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) - pixels.xy;
  vec3 colour = vec3(0);
  for (int row = 0; row < pixels.z; ++row) {
    int y = strip.y + row;
    colour += texelFetch(strips, ivec2(strip.x + at.x, y), 0).rgb * texelFetch(strips, ivec2(strip.x + strip.z + at.y, y), 0).r;
  }
  sum = vec4(colour * share(start + gl_FragCoord.xy / scale), 0);
}`;

/** The sum, clipped, on the canvas; nothing where a tile is missing. */
const SHOW = `${COMMON}
layout(location = 0) in vec2 corner;
void main() { gl_Position = vec4(corner, 0, 1); }`;

const SHOW_PIXEL = `${COMMON}
uniform sampler2D sums;
out vec4 shown;

void main() {
  vec4 sum = texelFetch(sums, ivec2(gl_FragCoord.x, size.y - gl_FragCoord.y), 0);
  shown = sum.a > 0.999 ? vec4(floor(clamp(sum.rgb, 0.0, 1.0) * 255.0 + 0.5) / 255.0, 1) : vec4(0);
}`;

/** By name: [vertex, fragment]. */
export const SHADERS = {
  gaussian: [GAUSSIAN, GAUSSIAN_PIXEL],
  base: [BASE, BASE_PIXEL],
  rows: [ROWS, ROWS_PIXEL],
  cell: [CELL, CELL_PIXEL],
  show: [SHOW, SHOW_PIXEL],
};
