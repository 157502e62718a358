/** Pixels of tests: four samples of 8 bits each, row by row. */

import assert from "node:assert/strict";

/** The largest difference of two samples at the same place. */
export function farthest(found, expected) {
  assert.equal(found.length, expected.length);
  return found.reduce((most, value, at) => Math.max(most, Math.abs(value - expected[at])), 0);
}

/** Columns `first` to before `stop` of pixels. */
export function part(pixels, width, first, stop) {
  const each = 4 * (stop - first);
  return Uint8ClampedArray.from({ length: (pixels.length / width / 4) * each }, (_, at) => pixels[4 * (Math.floor(at / each) * width + first) + (at % each)]);
}

/** Pixels as they are seen on black. */
export function onBlack(pixels) {
  return pixels.map((value, at) => (at % 4 === 3 ? 255 : Math.round((value * pixels[at - (at % 4) + 3]) / 255)));
}
