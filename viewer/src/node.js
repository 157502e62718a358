/** The decoder for Node, without workers or a canvas. */

import { readFile } from "node:fs/promises";
import { SgiError } from "./errors.js";
import { buildUrl } from "./module.js";
import { decodeHere } from "./whole.js";

export { SgiError };

let module_;

/** Decodes a stream, of a path, a URL or bytes, in this thread: {width, height, data}, red, green, blue, alpha. */
export async function decode(source, { width } = {}) {
  module_ ??= readFile(buildUrl()).then((bytes) => WebAssembly.compile(bytes));
  return decodeHere(await module_, await bytesOf(source), width);
}

async function bytesOf(source) {
  if (source instanceof Uint8Array) return source;
  const url = URL.canParse(source) ? new URL(source) : null;
  if (!url || url.protocol === "file:") return readFile(url ?? source);
  const answer = await fetch(url);
  if (!answer.ok) throw new SgiError(`The server refuses to send the file (HTTP ${answer.status}).`);
  return new Uint8Array(await answer.arrayBuffer());
}
