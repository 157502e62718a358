/** Reads PNG files of 8 bits, as `sgi decode` and screenshots are. */

import { inflateSync } from "node:zlib";

const CHANNELS = { 0: 1, 2: 3, 4: 2, 6: 4 };

/** {width, height, channels, pixels} */
export function readPng(data) {
  let width, height, channels;
  const parts = [];
  for (let at = 8; at < data.length; ) {
    const size = data.readUInt32BE(at);
    const kind = data.toString("latin1", at + 4, at + 8);
    const body = data.subarray(at + 8, at + 8 + size);
    if (kind === "IHDR") {
      [width, height, channels] = [body.readUInt32BE(0), body.readUInt32BE(4), CHANNELS[body[9]]];
      if (body[8] !== 8 || !channels || body[12]) throw new Error("a PNG that is not read here");
    }
    if (kind === "IDAT") parts.push(body);
    at += size + 12;
  }
  return { width, height, channels, pixels: unfiltered(inflateSync(Buffer.concat(parts)), width * channels, height, channels) };
}

function unfiltered(data, stride, height, channels) {
  const out = new Uint8Array(stride * height);
  for (let row = 0; row < height; row++) {
    const kind = data[row * (stride + 1)];
    for (let at = 0; at < stride; at++) {
      const here = row * stride + at;
      const left = at >= channels ? out[here - channels] : 0;
      const above = row ? out[here - stride] : 0;
      const corner = row && at >= channels ? out[here - stride - channels] : 0;
      const guess = [0, left, above, (left + above) >> 1, paeth(left, above, corner)][kind];
      out[here] = data[row * (stride + 1) + 1 + at] + guess;
    }
  }
  return out;
}

function paeth(a, b, c) {
  const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

/** Red, green, blue, alpha of each pixel. */
export function rgba({ channels, pixels }) {
  const out = new Uint8ClampedArray((pixels.length / channels) * 4);
  for (let at = 0, to = 0; at < pixels.length; at += channels, to += 4) {
    const isGray = channels < 3;
    out[to] = pixels[at];
    out[to + 1] = pixels[at + (isGray ? 0 : 1)];
    out[to + 2] = pixels[at + (isGray ? 0 : 2)];
    out[to + 3] = channels % 2 ? 255 : pixels[at + channels - 1];
  }
  return out;
}
