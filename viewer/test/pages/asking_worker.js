/** A worker that decodes a picture for a page, for decode.test.js. */
import { decode } from "/src/index.js";

self.onmessage = async ({ data }) => {
  const bitmap = await decode(data, { width: 96 });
  self.postMessage(bitmap, [bitmap]);
};
