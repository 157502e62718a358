/** A tile of the file on the GPU: what `viewer_model` (wasm/model.cpp) tells of it. */

const FACTS = 16;
const ROOT = 32; // pixels: no cell of texture is larger

let made = 0;

export class Tile {
  /** numbers: of `viewer_model`. */
  constructor(device, numbers) {
    const [x, y, width, height, gaussians, side, baseColumns, baseRows, cells, rows, atoms, restored] = numbers;
    Object.assign(this, { x, y, width, height, gaussians, side, base: [baseColumns, baseRows], cellCount: cells });
    this.isRestored = Boolean(restored); // by a network, which runs in workers
    let at = FACTS;
    const next = (count) => numbers.subarray(at, (at += count));
    this.id = ++made;
    this.device = device;
    this.bytes = numbers.byteLength;
    this.gaussianBuffer = device.buffer(next(8 * gaussians));
    this.gaussianArray = device.attributes(this.gaussianBuffer, [2, 3, 3]);
    this.baseList = device.list(next(4 * baseColumns * baseRows));
    this.setCells(next(8 * cells));
    this.rowList = device.list(next(4 * rows));
    this.atomList = device.list(next(4 * atoms));
  }

  /** Keeps cells by the root that they lie in, row by row. */
  setCells(cells) {
    this.roots = [Math.ceil(this.width / ROOT), Math.ceil(this.height / ROOT)];
    const rootOf = (cell) => Math.floor(cells[8 * cell + 1] / ROOT) * this.roots[0] + Math.floor(cells[8 * cell] / ROOT);
    this.starts = new Uint32Array(this.roots[0] * this.roots[1] + 1);
    for (let cell = 0; cell < this.cellCount; cell++) this.starts[rootOf(cell) + 1]++;
    for (let root = 1; root < this.starts.length; root++) this.starts[root] += this.starts[root - 1];
    const next = this.starts.slice();
    this.cells = new Float32Array(cells.length);
    for (let cell = 0; cell < this.cellCount; cell++) {
      this.cells.set(cells.subarray(8 * cell, 8 * cell + 8), 8 * next[rootOf(cell)]++);
    }
  }

  /** Where the grid of cells ends. */
  get gridEnd() {
    return this.roots.map((count) => count * ROOT);
  }

  /** Calls visit(cells, at) for those that may reach into a part of the tile; a cell's numbers begin at `at`. */
  forEachCell(left, top, right, bottom, visit) {
    const [across, down] = this.roots;
    const lastColumn = Math.min(across - 1, Math.floor(right / ROOT));
    const lastRow = Math.min(down - 1, Math.floor(bottom / ROOT));
    for (let row = Math.max(0, Math.floor(top / ROOT)); row <= lastRow; row++) {
      for (let column = Math.max(0, Math.floor(left / ROOT)); column <= lastColumn; column++) {
        const root = row * across + column;
        for (let cell = this.starts[root]; cell < this.starts[root + 1]; cell++) visit(this.cells, 8 * cell);
      }
    }
  }

  free() {
    for (const texture of [this.baseList, this.rowList, this.atomList]) this.device.free({ texture });
    this.device.free({ buffer: this.gaussianBuffer, array: this.gaussianArray });
  }
}
