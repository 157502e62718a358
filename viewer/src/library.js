/** The functions of libsgi's WebAssembly as JavaScript calls. */

const NOT_THERE = 52; // ENOSYS of WASI
const CACHE = 96 << 20; // bytes of decoded tiles that one worker keeps
const FACTS = 16; // numbers that viewer_info writes
const MOST_ELLIPSES = 20000;

/** One instance. `reader` has read(offset, count), which gives an array of bytes or throws. */
export class Library {
  constructor(module, reader) {
    this.reader = reader;
    this.failure = null;
    this.exports = new WebAssembly.Instance(module, this.imports(module)).exports;
    this.exports._initialize?.();
  }

  imports(module) {
    const all = {};
    for (const { module: space, name, kind } of WebAssembly.Module.imports(module)) {
      if (kind === "function") (all[space] ??= {})[name] = () => NOT_THERE;
    }
    all.env = { ...all.env, viewer_read: (offset, at, count) => this.readInto(offset, at, count) };
    return all;
  }

  readInto(offset, at, count) {
    try {
      const bytes = this.reader.read(offset, count);
      new Uint8Array(this.exports.memory.buffer).set(bytes, at);
      return bytes.length;
    } catch (error) {
      this.failure = error;
      return -1;
    }
  }

  /** Opens the file that the reader reads: a stream and its facts. */
  open() {
    const stream = this.exports.viewer_open(this.reader.size, CACHE);
    if (!stream) this.fail();
    return this.within(8 * FACTS, (at) => {
      this.exports.viewer_info(stream, at);
      const facts = new Float64Array(this.exports.memory.buffer, at, FACTS);
      const [width, height, channels, tiles, tileSize, hasOverview, levels, isPlain, apron] = facts;
      const flags = { hasOverview: Boolean(hasOverview), isPlain: Boolean(isPlain) };
      return { stream, info: { width, height, channels, tiles, tileSize, levels, apron, ...flags } };
    });
  }

  /** Pixels of a view, as of ImageData: red, green, blue, alpha. */
  draw(stream, { x, y, width, height, columns, rows }) {
    return this.within(4 * columns * rows, (at) => {
      if (this.exports.viewer_draw(stream, x, y, width, height, columns, rows, at)) this.fail();
      return new Uint8ClampedArray(this.exports.memory.buffer, at, 4 * columns * rows).slice();
    });
  }

  /** The ellipses of the Gaussians whose centres are in a region: how many there are, and those that are shown. */
  ellipses(stream, { x, y, width, height }) {
    return this.within(4 * 5 * MOST_ELLIPSES, (at) => {
      const total = this.exports.viewer_ellipses(stream, x, y, width, height, MOST_ELLIPSES, at);
      if (total < 0) this.fail();
      const count = Math.min(total, MOST_ELLIPSES);
      return { count, total, shapes: new Float32Array(this.exports.memory.buffer, at, 5 * count).slice() };
    });
  }

  /** The numbers of a tile of the file, as wasm/model.cpp tells them. */
  model(stream, number) {
    return this.within(4, (at) => {
      const count = this.exports.viewer_model(stream, number, at);
      if (count < 0) this.fail();
      const [first] = new Uint32Array(this.exports.memory.buffer, at, 1);
      return new Float32Array(this.exports.memory.buffer, first, count).slice();
    });
  }

  /** The checksum of all symbols. */
  verify(stream) {
    return this.within(4, (at) => {
      if (this.exports.viewer_verify(stream, at)) this.fail();
      return new Uint32Array(this.exports.memory.buffer, at, 1)[0];
    });
  }

  close(stream) {
    this.exports.viewer_close(stream);
  }

  within(size, work) {
    const at = this.exports.malloc(size);
    if (!at) throw new Error("There is not enough memory for this.");
    try {
      return work(at);
    } finally {
      this.exports.free(at);
    }
  }

  fail() {
    const failure = this.failure;
    this.failure = null;
    if (failure) throw failure;
    const memory = new Uint8Array(this.exports.memory.buffer);
    const at = this.exports.viewer_error();
    throw new Error(new TextDecoder().decode(memory.slice(at, memory.indexOf(0, at))));
  }
}
