/** A worker that decodes one stream: one instance of the library, one call at a time. */

import { ByteReader } from "./byte_reader.js";
import { outlines } from "./ellipses.js";
import { Library } from "./library.js";

let library, reader, stream;

self.onmessage = async ({ data: { job, task, module, place, view } }) => {
  try {
    const [answer, moved] = await work(task, module, place, view);
    self.postMessage({ job, answer, fetched: reader.fetched }, moved);
  } catch (error) {
    self.postMessage({ job, error: String(error?.message ?? error), fetched: reader?.fetched ?? 0 });
  }
};

async function work(task, module, place, view) {
  if (task === "open") {
    reader = new ByteReader(place);
    library = new Library(module, reader);
    const opened = library.open();
    stream = opened.stream;
    return [opened.info, []];
  }
  if (task === "ellipses") {
    const found = library.ellipses(stream, view.region);
    const bitmap = outlines(found, view.place);
    return [{ bitmap, count: found.count, total: found.total }, [bitmap]];
  }
  if (task === "model") {
    const numbers = library.model(stream, view.number);
    return [numbers, [numbers.buffer]];
  }
  const pixels = new ImageData(library.draw(stream, view), view.columns, view.rows);
  const bitmap = await createImageBitmap(pixels);
  return [bitmap, [bitmap]];
}
