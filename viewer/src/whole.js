/** A whole picture at some width, and how a program without workers decodes it. */

import { Library } from "./library.js";
import { SgiError, sentence } from "./errors.js";

/** The view of all of a picture, with `columns` pixels across. */
export function wholeView({ width, height }, columns = width) {
  const pixels = (count) => Math.max(1, Math.round(count));
  return { x: 0, y: 0, width, height, columns: pixels(columns), rows: pixels((height * columns) / width) };
}

/** Decodes a stream in this thread: {width, height, data}, as of ImageData. */
export function decodeHere(module, bytes, width) {
  try {
    const reader = { size: bytes.length, read: (offset, count) => bytes.subarray(offset, offset + count) };
    const stream = new Library(module).open(reader);
    const view = wholeView(stream.info, width);
    return { width: view.columns, height: view.rows, data: stream.draw(view) };
  } catch (error) {
    throw new SgiError(sentence(error));
  }
}
