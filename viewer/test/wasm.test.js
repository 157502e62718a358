/** The decoder's WebAssembly, both builds: symbols of all golden streams, pixels, errors, size. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";
import { Library } from "../src/library.js";
import { GOLDEN, ROOT, decoded, decodedBands, exactViews } from "./command.js";
import { farthest } from "./pixels.js";
import { rgba } from "./png.js";

const MOST_BYTES = 400_000;
const VIEWS = [[], ["--scale", "2"], ["--scale", "1/3"], ["--region", "8,4,40,24", "--scale", "2.5"]];
const IN_MANY = ["rgb8-texture", "rgb8-tiles-texture", "gray8-alpha", "rgba8-tiles-luma", "gray16", "paper-rgb8", "rgb8-restored"];
const manifest = JSON.parse(readFileSync(join(GOLDEN, "manifest.json")));

function opened(module, bytes) {
  const stream = new Library(module).open({ size: bytes.length, read: (offset, count) => bytes.subarray(offset, offset + count) });
  return { stream, info: stream.info };
}

for (const build of ["sgi", "sgi-scalar"]) {
  const file = readFileSync(join(ROOT, `viewer/src/wasm/${build}.wasm`));
  const module = new WebAssembly.Module(file);

  test(`${build}: symbols of every golden stream`, () => {
    assert.ok(Object.keys(manifest).length >= 25);
    for (const [name, { symbol_crc, picture }] of Object.entries(manifest)) {
      const { stream, info } = opened(module, readFileSync(join(GOLDEN, `${name}.sgi`)));
      assert.deepEqual([info.width, info.height], picture.slice(0, 2), name);
      assert.equal(stream.verify().toString(16).padStart(8, "0"), symbol_crc, name);
    }
  });

  test(`${build}: pixels of every golden stream are the command's`, () => {
    const exact = exactViews(Object.keys(manifest).map((name) => join(GOLDEN, `${name}.sgi`)));
    assert.ok(exact.size >= 5 && exact.size < Object.keys(manifest).length);
    for (const [name, { picture }] of Object.entries(manifest)) {
      const path = join(GOLDEN, `${name}.sgi`);
      const { stream, info } = opened(module, readFileSync(path));
      // The viewer applies a residual layer only where it corrects every view, as those of text and line art do.
      const lossy = exact.has(path) ? [] : ["--lossy"];
      const isSmall = Math.min(info.width, info.height) < 28;
      for (const options of isSmall ? VIEWS.slice(0, 2) : IN_MANY.includes(name) ? VIEWS : [VIEWS[0], VIEWS.at(-1)]) {
        const expected = (picture[2] === "multi" ? decodedBands : decoded)(path, ...options, ...lossy);
        const { width: columns, height: rows } = expected;
        const region = options.includes("--region") ? { x: 8, y: 4, width: 40, height: 24 } : { x: 0, y: 0, ...info };
        const found = stream.draw({ ...region, columns, rows });
        assert.equal(farthest(found, rgba(expected)), 0, `${name} ${options}`);
      }
    }
  });

  test(`${build}: ellipses of a region`, () => {
    const { stream, info } = opened(module, readFileSync(join(GOLDEN, "rgb8-tiles.sgi")));
    const whole = stream.ellipses({ x: 0, y: 0, width: info.width, height: info.height });
    assert.ok(whole.total >= 0.9 * manifest["rgb8-tiles"].seeds * 0.5);
    assert.equal(whole.count, whole.total);
    const half = info.width / 2;
    const parts = [0, half].map((x) => stream.ellipses({ x, y: 0, width: half, height: info.height }));
    assert.equal(parts[0].total + parts[1].total, whole.total);
    for (let at = 0; at < parts[0].count; at++) {
      const [x, , a, b] = parts[0].shapes.subarray(5 * at, 5 * at + 4);
      assert.ok(x < half && a >= b && b > 0);
    }
  });

  test(`${build}: errors are the library's`, () => {
    const bytes = readFileSync(join(GOLDEN, "rgb8.sgi"));
    assert.throws(() => opened(module, Buffer.from("no stream at all")), /signature|stream/);
    const flipped = Buffer.from(bytes);
    flipped[bytes.length >> 1] ^= 255;
    assert.throws(() => {
      const { stream, info } = opened(module, flipped);
      stream.draw({ x: 0, y: 0, ...info, columns: 8, rows: 8 });
    }, /CRC|checksum/);
    const broken = { size: bytes.length, read: () => { throw new Error("the cable is cut"); } };
    assert.throws(() => new Library(module).open(broken), /the cable is cut/);
  });

  test(`${build}: size`, (context) => {
    const brotli = brotliCompressSync(file, { params: { [constants.BROTLI_PARAM_LGWIN]: 22 } }).length;
    const gzip = gzipSync(file, { level: 9 }).length;
    context.diagnostic(`${build}.wasm: ${file.length} bytes, gzip -9 ${gzip}, brotli ${brotli}`);
    assert.ok(Math.max(gzip, brotli) <= MOST_BYTES);
  });
}
