/** One picture on the screen: cached tiles are drawn at once, then the view itself at its true scale and place. */

import { TileModels } from "./gpu/tile_models.js";

const TILE = 256;
const FINEST = 5; // tiles are drawn up to 2^5 pixels for each of the picture's
const MOST_TILES = 800;
const OVERVIEW = -4; // the level that a stream's overview has the pixels of
const SOFTEST = 3; // of the screen's pixels, before the device's ratio, that one of the overview's may fill
const MOST_SEEN = 64; // tiles of the file that a view reads where the overview is nearly as sharp
const REFINE = 1000; // priorities from here on: after all tiles

export class Layer {
  /** decoder: of decoder.js; changed(): something can be drawn; failed(error): a part cannot. */
  constructor(decoder, changed, failed) {
    this.decoder = decoder;
    this.changed = changed;
    this.failed = failed;
    this.tiles = new Map(); // key -> {bitmap} or {job}, the least recently used first
    this.cells = null; // of the refined view: {key, parts}
    const { width, height } = decoder.info;
    this.models = decoder.info.isPlain ? new TileModels(decoder, changed, failed) : null;
    this.coarsest = Math.floor(Math.log2(TILE / Math.max(width, height)));
  }

  /** What the GPU draws of a view, as of TileModels.plan; null where workers draw all of it. */
  plan(camera, renderer) {
    this.isPlanned = Boolean(renderer && this.models?.covers(camera));
    return this.isPlanned ? this.models.plan(camera, renderer) : null;
  }

  /** Draws what there is until the GPU has the tiles that are missing. */
  drawMissing(context, camera, missing) {
    this.forgetJobs(new Set());
    this.forgetCells();
    this.ask(this.tileOf(this.coarsest, 0, 0), -1);
    if (!missing.length) return;
    context.beginPath();
    for (const { x, y, width, height } of missing) {
      const [left, top] = camera.toScreen(x, y).map(Math.floor);
      const [right, bottom] = camera.toScreen(x + width, y + height).map(Math.ceil);
      context.rect(left, top, right - left, bottom - top);
    }
    context.clip();
    for (const tile of this.visible(camera, this.levelOf(camera))) {
      const box = this.screenBox(tile, camera);
      const { bitmap } = this.tiles.get(tile.key) ?? {};
      if (bitmap) context.drawImage(bitmap, box[0], box[1], box[2] - box[0], box[3] - box[1]);
      else this.drawAncestor(context, tile, box);
    }
  }

  /** Draws what there is, and asks for what is missing. camera: in this picture's pixels. */
  draw(context, camera) {
    const level = this.levelOf(camera);
    const wanted = this.visible(camera, level);
    this.forgetJobs(new Set(wanted.map(({ key }) => key)));
    this.ask(this.tileOf(this.coarsest, 0, 0), -1);
    const middle = [camera.columns / 2, camera.rows / 2];
    for (const tile of wanted) {
      const { bitmap } = this.tiles.get(tile.key) ?? {};
      const box = this.screenBox(tile, camera);
      if (!bitmap) {
        this.ask(tile, Math.hypot((box[0] + box[2]) / 2 - middle[0], (box[1] + box[3]) / 2 - middle[1]) / 1e4);
        this.drawAncestor(context, tile, box);
      } else {
        this.touch(tile.key);
        context.drawImage(bitmap, box[0], box[1], box[2] - box[0], box[3] - box[1]);
      }
    }
    if (this.cells?.key === camera.key) {
      for (const { bitmap, column, row } of this.cells.parts) {
        if (!bitmap) continue;
        context.clearRect(column, row, bitmap.width, bitmap.height); // what is transparent must not show the tiles
        context.drawImage(bitmap, column, row);
      }
    }
  }

  /** Asks for the view at its true scale, unless the tiles show it pixel by pixel. */
  refine(camera) {
    if (this.cells?.key === camera.key || !this.decoder.isContinuous || this.isExact(camera)) return;
    if (this.isPlanned || this.isTooMuch(camera)) return;
    this.forgetCells();
    const { width, height } = this.decoder.info;
    const [left, top] = camera.toScreen(0, 0);
    const [right, bottom] = camera.toScreen(width, height);
    const cells = { key: camera.key, parts: [], jobs: [] };
    this.cells = cells;
    const [first, last] = [Math.max(0, Math.ceil(left - 0.5)), Math.min(camera.columns, Math.ceil(right - 0.5))];
    const [above, below] = [Math.max(0, Math.ceil(top - 0.5)), Math.min(camera.rows, Math.ceil(bottom - 0.5))];
    for (let row = above; row < below; row += TILE) {
      for (let column = first; column < last; column += TILE) {
        const columns = Math.min(TILE, last - column);
        const rows = Math.min(TILE, below - row);
        const [x, y] = camera.toPicture(column, row);
        const view = { x, y, width: columns / camera.scale, height: rows / camera.scale, columns, rows };
        const job = this.decoder.draw(view, REFINE);
        const part = { column, row, bitmap: null };
        cells.parts.push(part);
        cells.jobs.push(job);
        job.promise.then(
          (bitmap) => this.arrived(part, bitmap, cells),
          (error) => {
            part.failed = true;
            this.lost(error);
          },
        );
      }
    }
  }

  arrived(part, bitmap, cells) {
    if (this.cells !== cells) return bitmap.close();
    part.bitmap = bitmap;
    this.changed();
  }

  /** Whether nothing is being drawn: the screen shows the best there is. */
  get isDone() {
    const waits = [...this.tiles.values()].some(({ job }) => job);
    if (this.isPlanned && !this.models.isDone) return false;
    return !waits && !(this.cells?.parts ?? []).some(({ bitmap, failed }) => !bitmap && !failed);
  }

  /** The level of tiles that has no fewer pixels than the screen, or that of the overview where it has to do. */
  levelOf(camera) {
    const level = Math.min(FINEST, Math.max(this.coarsest, Math.ceil(Math.log2(camera.scale) - 1e-6)));
    return this.isTooMuch(camera) ? Math.min(level, OVERVIEW) : level;
  }

  /** Whether a view would read a great part of a large file, to be little sharper than the overview. */
  isTooMuch({ scale, seen }) {
    const { hasOverview, tileSize } = this.decoder.info;
    const ratio = Math.max(1, globalThis.devicePixelRatio || 1);
    const beyond = hasOverview && scale > 2 ** OVERVIEW && scale < SOFTEST * ratio * 2 ** OVERVIEW;
    return beyond && seen.width * seen.height > MOST_SEEN * tileSize ** 2;
  }

  isExact(camera) {
    const [left, top] = camera.toScreen(0, 0);
    const whole = (value) => Math.abs(value - Math.round(value)) < 1e-6;
    return Math.abs(Math.log2(camera.scale) - this.levelOf(camera)) < 1e-9 && whole(left) && whole(top);
  }

  visible(camera, level) {
    const { x, y, width, height } = camera.seen;
    const { width: across, height: down } = this.decoder.info;
    const side = TILE / 2 ** level;
    const found = [];
    if (!(width > 0 && height > 0)) return found;
    const lastColumn = Math.min(Math.ceil((x + width) / side), Math.ceil(across / side));
    const lastRow = Math.min(Math.ceil((y + height) / side), Math.ceil(down / side));
    for (let row = Math.floor(y / side); row < lastRow; row++) {
      for (let column = Math.floor(x / side); column < lastColumn; column++) found.push(this.tileOf(level, column, row));
    }
    return found;
  }

  tileOf(level, column, row) {
    return { level, column, row, key: `${level}/${column}/${row}` };
  }

  /** The tile's view: at the right and lower end as many pixels as have their centre in the picture, at least one. */
  viewOf({ level, column, row }) {
    const scale = 2 ** level;
    const side = TILE / scale;
    const [x, y] = [column * side, row * side];
    const columns = Math.min(TILE, Math.max(1, Math.round((this.decoder.info.width - x) * scale)));
    const rows = Math.min(TILE, Math.max(1, Math.round((this.decoder.info.height - y) * scale)));
    return { x, y, width: columns / scale, height: rows / scale, columns, rows };
  }

  screenBox(tile, camera) {
    const { x, y, width, height } = this.viewOf(tile);
    return [...camera.toScreen(x, y), ...camera.toScreen(x + width, y + height)].map(Math.round);
  }

  /** Draws the tile's part of the nearest coarser tile that is there. */
  drawAncestor(context, tile, [left, top, right, bottom]) {
    const view = this.viewOf(tile);
    for (let up = 1; tile.level - up >= this.coarsest; up++) {
      const above = this.tileOf(tile.level - up, tile.column >> up, tile.row >> up);
      const { bitmap } = this.tiles.get(above.key) ?? {};
      if (!bitmap) continue;
      const from = this.viewOf(above);
      const scale = 2 ** above.level;
      const source = [(view.x - from.x) * scale, (view.y - from.y) * scale, view.width * scale, view.height * scale];
      context.drawImage(bitmap, ...source, left, top, right - left, bottom - top);
      return;
    }
  }

  ask(tile, priority) {
    if (this.tiles.has(tile.key)) return;
    const job = this.decoder.draw(this.viewOf(tile), priority);
    this.tiles.set(tile.key, { job });
    job.promise.then(
      (bitmap) => {
        this.tiles.set(tile.key, { bitmap });
        this.evict();
        this.changed();
      },
      (error) => {
        this.tiles.delete(tile.key);
        this.lost(error, tile.key);
      },
    );
  }

  lost(error, key) {
    if (error.name === "AbortError") return;
    if (key) this.tiles.set(key, {}); // not again
    this.failed(error);
    this.changed();
  }

  touch(key) {
    const tile = this.tiles.get(key);
    this.tiles.delete(key);
    this.tiles.set(key, tile);
  }

  evict() {
    for (const [key, { bitmap }] of this.tiles) {
      if (this.tiles.size <= MOST_TILES) return;
      if (!bitmap || key === `${this.coarsest}/0/0`) continue;
      bitmap.close();
      this.tiles.delete(key);
    }
  }

  forgetJobs(needed) {
    for (const [key, { job }] of this.tiles) {
      if (job && !needed.has(key) && key !== `${this.coarsest}/0/0`) job.cancel();
    }
  }

  forgetCells() {
    for (const job of this.cells?.jobs ?? []) job.cancel();
    for (const { bitmap } of this.cells?.parts ?? []) bitmap?.close();
    this.cells = null;
  }

  close() {
    this.forgetCells();
    for (const { bitmap, job } of this.tiles.values()) {
      bitmap?.close();
      job?.cancel();
    }
    this.tiles.clear();
    this.models?.forget();
    this.decoder.close();
  }
}
