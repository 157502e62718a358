/**
 * A decoder gives parts of a picture at any scale. There are three: streams in workers, pictures that the browser
 * reads, and pictures that a IIIF server draws. Each has
 *
 *   info: {width, height, name, kind, bytes, tileSize, hasOverview};
 *     pixelMetres: the side of a pixel, null where nothing says it
 *   fetched: bytes that came over the network so far
 *   isContinuous: whether it can draw between pixels, at any place and scale
 *   draw(view, priority) -> {promise of an ImageBitmap, cancel()}; view: {x, y, width, height, columns, rows}
 *   ellipses(region, {left, top, scale, columns, rows}) -> promise of {count, total, bitmap: of the screen} or null
 *   close()
 */

import { placeOf } from "./bytes.js";
import { PictureDecoder } from "./picture_decoder.js";
import { IiifDecoder } from "./iiif_decoder.js";
import { StreamDecoder } from "./stream_decoder.js";
import { hasModule } from "./module.js";
import { wholeView } from "./whole.js";

const SIGNATURE = [0x89, 0x53, 0x47, 0x49, 0x0d, 0x0a, 0x1a, 0x0a]; // docs/format.md

/** Opens a File, a Blob or a URL: a stream by its first bytes, else what the browser can read. */
export async function openDecoder(source) {
  if (typeof source === "string" && !(await hasModule())) {
    const iiif = await IiifDecoder.open(source);
    if (iiif) return iiif;
  }
  const { place, fetched, name } = await placeOf(source);
  const start = await firstBytes(place);
  const isStream = SIGNATURE.every((byte, at) => start[at] === byte);
  if (isStream) return StreamDecoder.open(place, fetched, name);
  return PictureDecoder.open(source, place, fetched, name);
}

/** A picture as an ImageBitmap, with `width` pixels across: as many as it has, where nothing is said. */
export async function decode(source, { width } = {}) {
  const decoder = await openDecoder(source);
  try {
    return await decoder.draw(wholeView(decoder.info, width), 0).promise;
  } finally {
    decoder.close();
  }
}

async function firstBytes(place) {
  if (place.kind === "blob") return new Uint8Array(await place.blob.slice(0, SIGNATURE.length).arrayBuffer());
  return new Uint8Array(place.kind === "url" ? place.head : place.bytes, 0, Math.min(SIGNATURE.length, place.size));
}
