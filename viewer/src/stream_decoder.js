/** A stream, decoded by libsgi in workers. */

import { loadModule } from "./module.js";
import { openFile } from "./worker_pool.js";
import { SgiError } from "./errors.js";

const OVERVIEW = 16; // pixels of the picture's side for each of its overview's
const MOST_TILES = 6; // whose ellipses are shown at a time

export class StreamDecoder {
  static async open(place, fetched, name) {
    const module = await loadModule();
    if (!module) throw new SgiError("The decoder's WebAssembly is missing from this installation, or this browser has none.");
    const file = openFile({ module, place });
    try {
      const info = await file.run("info", null, -Infinity).promise;
      return new StreamDecoder(file, { ...info, name, kind: "stream", bytes: place.size }, fetched);
    } catch (error) {
      file.close();
      throw error;
    }
  }

  constructor(file, info, fetched) {
    this.file = file;
    this.info = info;
    this.before = fetched;
    this.isContinuous = true;
  }

  get fetched() {
    return this.before + this.file.fetched;
  }

  draw(view, priority) {
    return this.file.run("draw", view, priority, this.lane(view));
  }

  /** A picture of a region's ellipses on the screen; null where it has too many tiles to decode for it. */
  async ellipses(region, place) {
    const { tiles, tileSize } = this.info;
    if (tiles > 1 && region.width * region.height > MOST_TILES * tileSize ** 2) return null;
    return this.file.run("ellipses", { region, place }, 1e9, this.lane({ ...region, columns: Infinity })).promise;
  }

  close() {
    this.file.close();
  }

  /** The same worker for the same tile of the file, so that no two fetch and decode it. */
  lane({ x, y, width, height, columns }) {
    const { tileSize, hasOverview, tiles } = this.info;
    if (tiles === 1) return null;
    if (hasOverview && columns <= width / OVERVIEW) return 0;
    const place = (at, length) => Math.floor((at * Math.ceil(length / tileSize)) / length);
    const column = place(x + width / 2, this.info.width);
    const row = place(y + height / 2, this.info.height);
    return Math.max(0, column + 2 * row);
  }
}
