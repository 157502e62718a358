/** The tiles of a file that a view needs on the GPU: asked for, kept while there is room. */

const LEAST_SCALE = 1 / 4; // below, there is much more to sum than to see
const MOST_SCALE = 32;
const MOST_TILES = 48; // that a view may need
const MOST_PIXELS = 12e6; // of the picture that a view may show
const PATIENCE = 200; // milliseconds that a tile waits for the next ones before it is shown
const MOST_BYTES = 192 << 20; // that tiles not in view may take

export class TileModels {
  /** changed(): there is more to draw; failed(error): a tile cannot be. */
  constructor(decoder, changed, failed) {
    Object.assign(this, { decoder, changed, failed });
    const { width, height, tileSize } = decoder.info;
    this.counts = [width, height].map((length) => (tileSize ? Math.ceil(length / tileSize) : 1));
    this.entries = new Map(); // number -> {numbers}, {tile}, {job} or {}, the least recently used first
    this.renderer = null;
    this.timer = 0;
  }

  /** Why the GPU does not draw what the camera shows, as a few words; empty where it does. */
  refusal({ scale, seen }) {
    if (scale < LEAST_SCALE) return "the scale is below 1/4";
    if (scale > MOST_SCALE) return "the scale is above 32";
    if (seen.width * seen.height > MOST_PIXELS) return "more than 12 megapixels are seen";
    return this.needed(seen).length > MOST_TILES ? "more than 48 tiles of the file are seen" : "";
  }

  /** What to draw of a view, {shown: [{tile, fades}], missing: [boxes]}; asks for what is not there. */
  plan(camera, renderer) {
    if (this.renderer !== renderer) this.forget(renderer);
    const needed = this.needed(camera.seen);
    const numbers = new Set(needed.map(({ number }) => number));
    for (const [number, { job }] of this.entries) if (job && !numbers.has(number)) job.cancel();
    const plan = { shown: [], missing: [] };
    for (const box of needed) {
      const entry = this.entries.get(box.number) ?? this.ask(box, camera);
      if (entry.numbers) Object.assign(entry, { tile: renderer.upload(entry.numbers), numbers: null });
      if (!entry.tile) plan.missing.push(box);
      else plan.shown.push({ tile: entry.tile, fades: box.fades });
      this.entries.delete(box.number);
      this.entries.set(box.number, entry);
    }
    this.evict(numbers);
    return plan;
  }

  /** The boxes of the tiles that reach into a region, with how wide their sides fade into the next ones. */
  needed({ x, y, width, height }) {
    const across = this.along(0, x, x + width);
    const down = this.along(1, y, y + height);
    const box = (row, column) => ({
      number: row.index * this.counts[0] + column.index,
      x: column.begin,
      y: row.begin,
      width: column.end - column.begin,
      height: row.end - row.begin,
      fades: [column.before, row.before, column.behind, row.behind],
    });
    return down.flatMap((row) => across.map((column) => box(row, column)));
  }

  along(axis, low, high) {
    const { apron, width, height } = this.decoder.info;
    const [length, count] = [axis ? height : width, this.counts[axis]];
    const edge = (index) => Math.floor((index * length) / count);
    const found = [];
    const first = Math.max(0, Math.floor(((low - apron) * count) / length) - 1);
    for (let index = first; index < count && edge(index) - apron < high; index++) {
      const [isFirst, isLast] = [index === 0, index === count - 1];
      const begin = edge(index) - (isFirst ? 0 : apron);
      const end = edge(index + 1) + (isLast ? 0 : apron);
      if (end > low) found.push({ index, begin, end, before: isFirst ? -1 : 2 * apron, behind: isLast ? -1 : 2 * apron });
    }
    return found;
  }

  ask(box, camera) {
    const [column, row] = camera.toScreen(box.x + box.width / 2, box.y + box.height / 2);
    const priority = Math.hypot(column - camera.columns / 2, row - camera.rows / 2) / 1e4;
    const job = this.decoder.model(box.number, priority);
    const entry = { job };
    this.entries.set(box.number, entry);
    job.promise.then(
      (numbers) => Object.assign(entry, { job: null, numbers }),
      (error) => {
        entry.job = null; // and not again
        if (error.name !== "AbortError") return this.failed(error);
        if (this.entries.get(box.number) === entry) this.entries.delete(box.number);
      },
    ).then(() => this.arrived());
    return entry;
  }

  /** Has what arrived shown, several tiles at a time: each time all of them are drawn. */
  arrived() {
    const waits = [...this.entries.values()].some(({ job }) => job);
    if (waits && this.timer) return;
    clearTimeout(this.timer);
    const show = () => {
      this.timer = 0;
      this.changed();
    };
    this.timer = waits ? setTimeout(show, PATIENCE) : 0;
    if (!waits) this.changed();
  }

  get isDone() {
    return ![...this.entries.values()].some(({ job, numbers }) => job || numbers);
  }

  evict(needed) {
    let bytes = 0;
    for (const { tile } of this.entries.values()) bytes += tile?.bytes ?? 0;
    for (const [number, { tile }] of this.entries) {
      if (bytes <= MOST_BYTES) return;
      if (!tile || needed.has(number)) continue;
      bytes -= tile.bytes;
      tile.free();
      this.entries.delete(number);
    }
  }

  /** Begins anew with a renderer, or none: what the old one holds is lost or freed. */
  forget(renderer = null) {
    clearTimeout(this.timer);
    this.timer = 0;
    for (const { tile, job } of this.entries.values()) {
      job?.cancel();
      tile?.free();
    }
    this.entries.clear();
    this.renderer = renderer;
  }
}
