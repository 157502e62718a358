/** A picture that the browser itself can read, to compare a stream with; a worker reads and draws it. */

import { SgiError } from "./errors.js";
import { WorkerPool } from "./worker_pool.js";

export class PictureDecoder {
  static async open(source, place, fetched, name) {
    let blob = source instanceof Blob ? source : new Blob([place.bytes ?? place.head]);
    if (place.kind === "url") {
      blob = await (await fetch(place.url)).blob();
      fetched = blob.size;
    }
    const pool = new WorkerPool(1, { place: blob }, drawer);
    try {
      const { width, height } = await pool.opened;
      const info = { width, height, name, kind: "picture", bytes: blob.size, tileSize: 0, tiles: 1, hasOverview: false };
      return new PictureDecoder(pool, info, fetched);
    } catch {
      pool.close();
      throw new SgiError("The file is no .sgi stream, and no picture that this browser can show.");
    }
  }

  constructor(pool, info, fetched) {
    Object.assign(this, { pool, info, fetched });
    this.isContinuous = true;
  }

  draw(view, priority) {
    return this.pool.run("draw", view, priority);
  }

  async ellipses() {
    return null;
  }

  close() {
    this.pool.close();
  }
}

/** One for each picture: it holds all pixels, and the page stays free. */
function drawer() {
  return new Worker(new URL("./picture_worker.js", import.meta.url), { type: "module" });
}
