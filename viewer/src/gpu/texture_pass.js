/** Draws the texture of tiles: strips for the cells that are seen, many at a time, and then the cells from these. */

const COLUMNS = 4096; // of the buffer of strips: a cell at 32 pixels for each of its own has 2562
const ROWS = 512;
const CLASS = 4; // rows of amplitudes: strips of about the same height lie side by side
const NUMBERS = 12; // of an instance
const MOST = 16384; // cells drawn at a time
const OVERLAP = 4; // pixels by which cells reach over each other

export class TexturePass {
  constructor(device) {
    this.device = device;
    this.strips = device.target(COLUMNS, ROWS);
    this.instances = new Float32Array(NUMBERS * MOST);
    this.buffer = device.buffer(this.instances);
    this.array = device.attributes(this.buffer, [4, 4, 4]);
    this.empty();
  }

  empty() {
    this.count = this.top = 0;
    this.shelves = new Map(); // height -> {x, y} of the next strip
  }

  /** Adds a tile's texture to `target`. part: {left, top, right, bottom} of the screen; uniforms: of the tile. */
  draw(tile, target, part, uniforms) {
    if (!tile.cellCount) return;
    const { start, scale } = uniforms;
    const [deviation, step, nodes] = uniforms.blur;
    const spread = deviation > 0 ? nodes * step : 0;
    const reach = OVERLAP + spread;
    const ends = tile.gridEnd;
    const span = [0, 0, 0, 0];
    // First pixel and how many of an axis a cell reaches.
    const along = (axis, begin, side, low, high) => {
      const first = (begin - (begin === 0 ? spread : reach) - start[axis]) * scale - 0.5;
      const last = (begin + side + (begin + side === ends[axis] ? spread : reach) - start[axis]) * scale - 0.5;
      span[axis] = Math.max(low, Math.ceil(first));
      span[axis + 2] = Math.min(high, Math.floor(last) + 1) - span[axis];
      return span[axis + 2] > 0;
    };
    const view = (pixel, axis) => start[axis] + pixel / scale;
    const far = reach + 32;
    const seen = [view(part.left, 0) - far, view(part.top, 1) - far, view(part.right, 0) + far, view(part.bottom, 1) + far];
    tile.forEachCell(...seen, (cells, at) => {
      if (!along(0, cells[at], cells[at + 2], part.left, part.right)) return;
      if (!along(1, cells[at + 1], cells[at + 3], part.top, part.bottom)) return;
      const width = span[2] + span[3];
      const rows = cells[at + 5];
      if (this.count === MOST || !this.place(width, rows)) {
        this.flush(tile, target, uniforms);
        this.place(width, rows);
      }
      this.note(span, cells, at);
    });
    this.flush(tile, target, uniforms);
  }

  /** Finds room for a strip, at this.x and this.y; false where there is none left. */
  place(width, rows) {
    const height = Math.ceil(rows / CLASS) * CLASS;
    let shelf = this.shelves.get(height);
    if (!shelf || shelf.x + width > COLUMNS) {
      if (this.top + height > ROWS) return false;
      shelf = { x: 0, y: this.top };
      this.top += height;
      this.shelves.set(height, shelf);
    }
    this.x = shelf.x;
    this.y = shelf.y;
    shelf.x += width;
    return true;
  }

  note([column, row, columns, rows], cells, at) {
    const to = NUMBERS * this.count++;
    const { instances } = this;
    instances[to] = this.x;
    instances[to + 1] = this.y;
    instances[to + 2] = columns;
    instances[to + 3] = rows;
    instances[to + 4] = column;
    instances[to + 5] = row;
    instances[to + 6] = cells[at + 5];
    instances[to + 7] = cells[at + 4];
    for (let i = 0; i < 4; i++) instances[to + 8 + i] = cells[at + i];
  }

  flush(tile, target, uniforms) {
    const { device, strips, count } = this;
    const { gl } = device;
    if (!count) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, this.instances.subarray(0, NUMBERS * count), gl.STREAM_DRAW);
    device.drawTo(strips, false);
    gl.disable(gl.SCISSOR_TEST);
    const lists = { rows: { unit: 0, texture: tile.rowList }, atoms: { unit: 1, texture: tile.atomList } };
    device.use("rows", { ...uniforms, ...lists, size: [COLUMNS, ROWS], gridEnd: tile.gridEnd });
    device.squares(this.array, count);
    gl.enable(gl.SCISSOR_TEST);
    device.drawTo(target, true);
    device.use("cell", { ...uniforms, strips: { unit: 0, texture: strips.texture } });
    device.squares(this.array, count);
    this.empty();
  }
}
