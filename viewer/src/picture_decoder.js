/** A picture that the browser itself can read, to compare a stream with; a worker reads and draws it. */

import { SgiError } from "./errors.js";
import { openFile } from "./worker_pool.js";

const LANE = 0; // one worker holds all pixels

export class PictureDecoder {
  static async open(source, place, fetched, name) {
    let blob = source instanceof Blob ? source : new Blob([place.bytes ?? place.head]);
    if (place.kind === "url") {
      blob = await (await fetch(place.url)).blob();
      fetched = blob.size;
    }
    const file = openFile({ place: blob });
    try {
      const { width, height } = await file.run("info", null, -Infinity, LANE).promise;
      const info = { width, height, name, kind: "picture", bytes: blob.size, tileSize: 0, tiles: 1, hasOverview: false };
      return new PictureDecoder(file, info, fetched);
    } catch {
      file.close();
      throw new SgiError("The file is no .sgi stream, and no picture that this browser can show.");
    }
  }

  constructor(file, info, fetched) {
    Object.assign(this, { file, info, fetched });
    this.isContinuous = true;
  }

  draw(view, priority) {
    return this.file.run("draw", view, priority, LANE);
  }

  async ellipses() {
    return null;
  }

  close() {
    this.file.close();
  }
}
