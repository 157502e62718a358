/**
 * A tile source of OpenSeadragon 6 for .sgi streams: it decodes in workers, and has levels beyond the picture's pixels.
 *
 *   import { register } from "sgi-viewer/openseadragon";
 *   register(OpenSeadragon);
 *   OpenSeadragon({ id: "viewer", tileSources: { type: "sgi", url: "city.sgi" }, maxZoomPixelRatio: 32 });
 *
 * `file: aFile` instead of `url` opens a File or a Blob.
 */

import { openDecoder } from "./decoder.js";
import { sentence } from "./errors.js";

const TILE = 512;
const OVERLAP = 1; // without one, OpenSeadragon stretches tiles by a pixel to hide seams
const BEYOND = 5; // levels beyond the picture's own: each has twice the pixels of the one before

/** Where a tile begins along an axis of this length, and how far it reaches, in pixels of its level. */
function span(number, length) {
  const start = Math.max(0, number * TILE - OVERLAP);
  return [start, Math.min((number + 1) * TILE + OVERLAP, length) - start];
}

/** Adds SgiTileSource to OpenSeadragon, which then knows {type: "sgi"}. Returns the class. */
export function register(OpenSeadragon) {
  class SgiTileSource extends OpenSeadragon.TileSource {
    constructor({ url, file, ...options }) {
      super({ ...options, url: url ?? `file:${file.name ?? ""}` });
      this.file = file ?? null;
      this.decoder = null;
    }

    supports(data) {
      return data?.type === "sgi";
    }

    configure(options) {
      return options;
    }

    async getImageInfo(url) {
      try {
        this.decoder = await openDecoder(this.file ?? url);
      } catch (error) {
        this.raiseEvent("open-failed", { message: sentence(error), source: url });
        return;
      }
      const { width, height } = this.decoder.info;
      this.own = Math.ceil(Math.log2(Math.max(width, height, TILE) / TILE)); // the level of the picture's pixels
      const levels = { minLevel: 0, maxLevel: this.own + BEYOND };
      Object.assign(this, { width, height, tileWidth: TILE, tileHeight: TILE, tileOverlap: OVERLAP, ...levels });
      this.raiseEvent("ready", { tileSource: this });
    }

    getLevelScale(level) {
      return 2 ** (level - (this.own ?? 0));
    }

    getTileUrl(level, x, y) {
      return `${this.url}#${level}/${x}/${y}`;
    }

    getTilePostData(level, x, y) {
      return { level, x, y };
    }

    hasTransparency() {
      return true;
    }

    equals(other) {
      return this.url === other?.url;
    }

    downloadTileStart(job) {
      const { level, x, y } = job.postData;
      const { width, height } = this.decoder.info;
      const scale = this.getLevelScale(level);
      const [left, across] = span(x, width * scale);
      const [top, down] = span(y, height * scale);
      const view = { x: left / scale, y: top / scale, width: across / scale, height: down / scale };
      const drawn = this.decoder.draw({ ...view, columns: Math.ceil(across), rows: Math.ceil(down) }, -level);
      job.userData.drawn = drawn;
      drawn.promise.then(
        (bitmap) => job.finish(bitmap, null, "imageBitmap"),
        (error) => job.fail(sentence(error)),
      );
    }

    downloadTileAbort(job) {
      job.userData.drawn?.cancel();
    }

    destroy() {
      this.decoder?.close();
    }
  }
  OpenSeadragon.SgiTileSource = SgiTileSource;
  return SgiTileSource;
}
