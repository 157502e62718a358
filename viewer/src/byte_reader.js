/** Reads bytes at once, as a decoder in a worker needs them: from memory, from a file, or by HTTP ranges. */

const BLOCK = 1 << 15;
const MOST_BLOCKS = 2048;

/** Reads from a place (bytes.js). `fetched` counts the bytes that came over the network. */
export class ByteReader {
  constructor(place) {
    this.size = place.size;
    this.fetched = 0;
    this.place = place;
    this.blocks = new Map(); // number -> Uint8Array, the least recently used first
    if (place.kind === "url") this.keep(0, new Uint8Array(place.head), Math.floor(place.head.byteLength / BLOCK));
  }

  /** The bytes from `offset` on, fewer at the end of the file. Throws an Error with a sentence. */
  read(offset, count) {
    const end = Math.min(offset + count, this.size);
    if (offset >= end) return new Uint8Array(0);
    if (this.place.kind === "bytes") return new Uint8Array(this.place.bytes, offset, end - offset);
    if (this.place.kind === "blob") return this.ofBlob(offset, end);
    const first = Math.floor(offset / BLOCK);
    const last = Math.floor((end - 1) / BLOCK);
    const needed = new Map();
    for (let number = first; number <= last; number++) {
      if (!this.blocks.has(number)) {
        let stop = number;
        while (stop < last && !this.blocks.has(stop + 1)) stop++;
        const bytes = this.ofUrl(number * BLOCK, Math.min((stop + 1) * BLOCK, this.size));
        for (let at = number; at <= stop; at++) needed.set(at, bytes.subarray((at - number) * BLOCK, (at - number + 1) * BLOCK));
        number = stop;
      }
    }
    const found = new Uint8Array(end - offset);
    for (let number = first; number <= last; number++) {
      const block = needed.get(number) ?? this.blocks.get(number);
      const start = Math.max(offset, number * BLOCK);
      const part = block.subarray(start - number * BLOCK, Math.min(end, (number + 1) * BLOCK) - number * BLOCK);
      found.set(part, start - offset);
    }
    for (const [number, block] of needed) this.blocks.set(number, block.slice());
    while (this.blocks.size > MOST_BLOCKS) this.blocks.delete(this.blocks.keys().next().value);
    return found;
  }

  keep(first, bytes, count) {
    for (let at = 0; at < count; at++) this.blocks.set(first + at, bytes.slice(at * BLOCK, (at + 1) * BLOCK));
  }

  ofBlob(offset, end) {
    return new Uint8Array(new FileReaderSync().readAsArrayBuffer(this.place.blob.slice(offset, end)));
  }

  ofUrl(start, end) {
    const request = new XMLHttpRequest();
    request.open("GET", this.place.url, false);
    request.responseType = "arraybuffer";
    request.setRequestHeader("Range", `bytes=${start}-${end - 1}`);
    try {
      request.send();
    } catch {
      throw new Error("The connection to the server broke.");
    }
    const bytes = new Uint8Array(request.response ?? 0);
    this.fetched += bytes.length;
    if (request.status === 200 && bytes.length === this.size) return bytes.subarray(start, end);
    if (request.status !== 206) throw new Error(`The server refuses to send a part of the file (HTTP ${request.status}).`);
    if (bytes.length !== end - start) throw new Error("The file has changed on the server; open it again.");
    return bytes;
  }
}
