/** Sizes of pixels, scale bars and addresses, without a browser. */

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { hashOf, viewOf } from "../src/address.js";
import { Camera } from "../src/camera.js";
import { HELP } from "../src/help.js";
import { Library } from "../src/library.js";
import { pixelSize } from "../src/pixel_size.js";
import { scaleBar } from "../src/scale_bar.js";
import { PYTHON, ROOT } from "./command.js";

const BUILD = join(ROOT, "viewer/src/wasm/sgi.wasm");

let folder, module;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "sgi-measured-"));
  execFileSync(PYTHON, [join(ROOT, "viewer/test/measured.py"), folder]);
  module = await WebAssembly.compile(readFileSync(BUILD));
});

after(() => rmSync(folder, { recursive: true }));

/** What the page's worker finds of a stream. */
function sizeOf(name) {
  const bytes = readFileSync(join(folder, `${name}.sgi`));
  const stream = new Library(module).open({ size: bytes.length, read: (offset, count) => bytes.subarray(offset, offset + count) });
  return pixelSize(stream.metadata("g"), stream.metadata("c"), stream.info);
}

const ARC = (Math.PI / 180 / 3600) * 6378137; // metres of a second of longitude at the equator
const SIZES = {
  metres: 10,
  turned: 30,
  feet: (2 * 1200) / 3937,
  mercator: 50, // at 60° the map is twice as large as the ground
  degrees: ARC / 2,
  microns: 0.25e-6,
  aperio: 0.504e-6,
  print: null, // 300 pixels per inch are no measurement
};

for (const [name, expected] of Object.entries(SIZES)) {
  test(`the size of a pixel: ${name}`, () => {
    const found = sizeOf(name);
    if (expected === null) assert.equal(found, null);
    else assert.ok(Math.abs(found / expected - 1) < 1e-4, `${found} instead of ${expected}`);
  });
}

test("the size of a pixel: damaged tags say nothing", () => {
  const info = { width: 96, height: 96 };
  const bytes = new Uint8Array(readFileSync(join(folder, "metres.sgi")));
  const start = bytes.findIndex((byte, at) => byte === 0x49 && bytes[at + 1] === 0x49 && bytes[at + 2] === 42);
  const place = bytes.slice(start, -60);
  assert.equal(pixelSize(place, null, info), 10);
  for (let length = 0; length < 120; length++) assert.equal(pixelSize(place.slice(0, length), null, info), null);
  assert.equal(pixelSize(null, null, info), null);
});

test("the scale bar has a round length that fits", () => {
  assert.deepEqual(scaleBar(1, 160, null), { pixels: 100, text: "100 px" });
  assert.deepEqual(scaleBar(32, 160, null), { pixels: 160, text: "5 px" });
  assert.deepEqual(scaleBar(2, 160, 10), { pixels: 100, text: "500 m" });
  assert.equal(scaleBar(0.125, 160, 10).text, "10 km");
  assert.equal(scaleBar(1, 160, 0.25e-6).text, "20 µm");
  assert.equal(scaleBar(32, 160, 0.25e-6).text, "1 µm");
  assert.equal(scaleBar(32, 100, 0.1e-6).text, "200 nm");
  assert.equal(scaleBar(1 / 64, 160, 0.25e-6).text, "2 mm");
  for (let scale = 0.01; scale < 32; scale *= 1.07) {
    const { pixels } = scaleBar(scale, 160, 0.37);
    assert.ok(pixels <= 160.0001 && pixels > 64 * 0.99, `${pixels} at ${scale}`);
  }
});

test("an address names the view that it was made of", () => {
  const camera = Object.assign(new Camera(), { columns: 800, rows: 500, width: 12288, height: 9000 });
  camera.fit();
  assert.equal(hashOf(camera), "");
  for (const [x, y, scale] of [[5000, 700, 2.5], [12000.5, 8999, 32], [6144, 4500, 0.125]]) {
    camera.lookAt({ x, y, scale });
    const view = viewOf(hashOf(camera));
    assert.ok(Math.abs(view.x - x) * scale <= 1 && Math.abs(view.y - y) * scale <= 1 && Math.abs(view.scale / scale - 1) < 1e-4);
  }
  camera.lookAt({ x: -50, y: 1e9, scale: 1000 });
  assert.deepEqual([camera.x, camera.y, camera.scale], [0, 9000, 32]);
  for (const none of ["", "#", "#top", "#1,2", "#1,2,0", "#1,2,-1", "#1,2,x", "#1,2,3,4", "#1,2,Infinity"]) assert.equal(viewOf(none), null);
});

test("the help of the page is the table of the documentation", () => {
  const text = readFileSync(join(ROOT, "docs/serve.md"), "utf8");
  const rows = text.split("## The viewer")[1].split("\n\n").find((block) => block.startsWith("| | |")).split("\n").slice(2);
  const cells = rows.map((row) => row.replaceAll("`", "").split(" | ").map((cell) => cell.replace(/^\| | \|$/g, "")));
  assert.deepEqual(cells, HELP);
});
