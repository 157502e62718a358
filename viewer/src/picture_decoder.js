/** A picture that the browser itself can read, to compare a stream with. */

import { SgiError } from "./errors.js";

export class PictureDecoder {
  static async open(source, place, fetched, name) {
    let blob = source instanceof Blob ? source : new Blob([place.bytes ?? place.head]);
    if (place.kind === "url") {
      blob = await (await fetch(place.url)).blob();
      fetched = blob.size;
    }
    try {
      const picture = await createImageBitmap(blob);
      return new PictureDecoder(picture, { name, kind: "picture", bytes: blob.size }, fetched);
    } catch {
      throw new SgiError("The file is no .sgi stream, and no picture that this browser can show.");
    }
  }

  constructor(picture, info, fetched) {
    this.picture = picture;
    this.fetched = fetched;
    this.isContinuous = true;
    const { width, height } = picture;
    this.info = { ...info, width, height, tileSize: 0, tiles: 1, hasOverview: false };
  }

  draw({ x, y, width, height, columns, rows }) {
    const canvas = new OffscreenCanvas(columns, rows);
    const context = canvas.getContext("2d");
    context.imageSmoothingQuality = "high";
    const [sx, sy] = [columns / width, rows / height];
    context.setTransform(sx, 0, 0, sy, -x * sx, -y * sy);
    context.drawImage(this.picture, 0, 0);
    return { promise: Promise.resolve(canvas.transferToImageBitmap()), cancel: () => {} };
  }

  async ellipses() {
    return null;
  }

  close() {
    this.picture.close();
  }
}
