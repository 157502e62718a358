/** A worker of the pool: one instance of the library decodes its streams; it also draws what the browser reads. */

import { ByteReader } from "./byte_reader.js";
import { outlines } from "./ellipses.js";
import { Library } from "./library.js";
import { pixelSize } from "./pixel_size.js";

const files = new Map(); // number of the file -> OpenStream or OpenPicture
let library;

self.onmessage = async ({ data: { file, opening, task, view } }) => {
  if (task === "close") {
    files.get(file)?.close();
    return files.delete(file);
  }
  const before = files.get(file)?.fetched ?? 0;
  let reply;
  let moved = [];
  try {
    if (opening) files.set(file, await (opening.module ? OpenStream : OpenPicture).open(opening));
    const answer = await files.get(file)[task](view);
    const isMoved = (part) => part instanceof ImageBitmap || part instanceof ArrayBuffer;
    moved = [answer.bitmap ?? answer, answer.buffer].filter(isMoved);
    reply = { answer };
  } catch (error) {
    reply = { error: String(error?.message ?? error), isBroken: error instanceof WebAssembly.RuntimeError };
  }
  self.postMessage({ ...reply, isOpen: files.has(file), fetched: (files.get(file)?.fetched ?? 0) - before }, moved);
};

class OpenStream {
  static open({ module, place }) {
    library ??= new Library(module);
    const reader = new ByteReader(place);
    return new OpenStream(reader, library.open(reader));
  }

  constructor(reader, stream) {
    Object.assign(this, { reader, stream });
  }

  get fetched() {
    return this.reader.fetched;
  }

  info() {
    const { info } = this.stream;
    return { ...info, pixelMetres: pixelSize(this.stream.metadata("g"), this.stream.metadata("c"), info) };
  }

  draw(view) {
    return createImageBitmap(new ImageData(this.stream.draw(view), view.columns, view.rows));
  }

  ellipses({ region, place }) {
    const found = this.stream.ellipses(region);
    return { bitmap: outlines(found, place), count: found.count, total: found.total };
  }

  close() {
    this.stream.close();
  }
}

class OpenPicture {
  static async open({ place }) {
    return new OpenPicture(await createImageBitmap(place));
  }

  constructor(picture) {
    this.picture = picture;
    this.fetched = 0;
  }

  info() {
    return { width: this.picture.width, height: this.picture.height };
  }

  draw({ x, y, width, height, columns, rows }) {
    const canvas = new OffscreenCanvas(columns, rows);
    const context = canvas.getContext("2d");
    context.imageSmoothingQuality = "high";
    const [sx, sy] = [columns / width, rows / height];
    context.setTransform(sx, 0, 0, sy, -x * sx, -y * sy);
    context.drawImage(this.picture, 0, 0);
    return canvas.transferToImageBitmap();
  }

  close() {
    this.picture.close();
  }
}
