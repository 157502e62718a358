/** The functions of libsgi's WebAssembly as JavaScript calls. */

const NOT_THERE = 52; // ENOSYS of WASI
const CACHE = 96 << 20; // bytes of decoded tiles that a worker keeps of each stream
const FACTS = 8; // numbers that viewer_info writes
const MOST_ELLIPSES = 20000;

/** One instance. It opens streams; their calls come one at a time. */
export class Library {
  constructor(module) {
    this.reader = null; // of the stream that is called
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

  /** Opens what a reader reads: it has size, and read(offset, count), which gives an array of bytes or throws. */
  open(reader) {
    this.reader = reader;
    const stream = this.exports.viewer_open(reader.size, CACHE);
    if (!stream) this.fail();
    return new Stream(this, reader, stream);
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

/** A stream that is open. */
class Stream {
  constructor(library, reader, stream) {
    Object.assign(this, { library, reader, stream });
    this.info = this.call(8 * FACTS, (exports, at) => {
      exports.viewer_info(stream, at);
      const facts = new Float64Array(exports.memory.buffer, at, FACTS);
      const [width, height, channels, tiles, tileSize, hasOverview, levels] = facts;
      return { width, height, channels, tiles, tileSize, levels, hasOverview: Boolean(hasOverview) };
    });
  }

  /** What work(exports, at) returns, with some bytes of memory at `at`. */
  call(size, work) {
    this.library.reader = this.reader;
    return this.library.within(size, (at) => work(this.library.exports, at));
  }

  /** A copy of metadata, by the letter of its chunk (docs/format.md); null where there is none. */
  metadata(letter) {
    return this.call(4, (exports, at) => {
      const size = exports.viewer_metadata(this.stream, letter.charCodeAt(0), at);
      const [first] = new Uint32Array(exports.memory.buffer, at, 1);
      return size ? new Uint8Array(exports.memory.buffer, first, size).slice() : null;
    });
  }

  /** Pixels of a view, as of ImageData: red, green, blue, alpha. */
  draw({ x, y, width, height, columns, rows }) {
    return this.call(4 * columns * rows, (exports, at) => {
      if (exports.viewer_draw(this.stream, x, y, width, height, columns, rows, at)) this.library.fail();
      return new Uint8ClampedArray(exports.memory.buffer, at, 4 * columns * rows).slice();
    });
  }

  /** The ellipses of the Gaussians whose centres are in a region: how many there are, and those that are shown. */
  ellipses({ x, y, width, height }) {
    return this.call(4 * 5 * MOST_ELLIPSES, (exports, at) => {
      const total = exports.viewer_ellipses(this.stream, x, y, width, height, MOST_ELLIPSES, at);
      if (total < 0) this.library.fail();
      const count = Math.min(total, MOST_ELLIPSES);
      return { count, total, shapes: new Float32Array(exports.memory.buffer, at, 5 * count).slice() };
    });
  }

  /** The checksum of all symbols. */
  verify() {
    return this.call(4, (exports, at) => {
      if (exports.viewer_verify(this.stream, at)) this.library.fail();
      return new Uint32Array(exports.memory.buffer, at, 1)[0];
    });
  }

  close() {
    this.library.exports.viewer_close(this.stream);
  }
}
