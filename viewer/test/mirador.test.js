/** Mirador shows what sgi serve offers by IIIF. Its bundle has all it needs (`npm run mirador`). */

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { launch, pageOf } from "./browser.js";
import { GOLDEN, PYTHON, ROOT, decoded } from "./command.js";
import { readPng, rgba } from "./png.js";
import { serve } from "./server.js";

const NAME = "rgb8-texture.sgi";
const PAGE = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
<style>html, body, #mirador { height: 100%; margin: 0; position: relative; }</style>
<script src="/mirador/dist/mirador.min.js"></script><div id="mirador"></div>`;

let browser, server, command, address, folder;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "sgi-mirador-"));
  writeFileSync(join(folder, "index.html"), PAGE);
  server = await serve({ "/mirador/": join(ROOT, "viewer/node_modules/mirador"), "/": folder });
  command = spawn(PYTHON, ["-m", "sgicodec", "serve", GOLDEN, "--port", "0"], { stdio: ["ignore", "ignore", "pipe"] });
  const [line] = await once(command.stderr, "data");
  address = /http:\/\/[\d.]+:\d+/.exec(line)[0];
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.close();
  command?.kill();
  rmSync(folder, { recursive: true });
});

test("a stream in Mirador, by its manifest", async () => {
  const page = await pageOf(browser, `${server.address}/`);
  const drawn = page.waitForResponse((answer) => /\.jpg$/.test(answer.url()));
  await page.evaluate((manifestId) => (globalThis.mirador = Mirador.viewer({ id: "mirador", windows: [{ manifestId }] })), `${address}/iiif/3/${NAME}/manifest.json`);
  assert.equal((await drawn).status(), 200);
  const expected = decoded(join(GOLDEN, NAME));
  const pixels = rgba(expected);
  const canvas = page.locator(".openseadragon-canvas canvas").first();
  for (let turn = 0, apart = 256; apart > 6; turn++) {
    assert.ok(turn < 100, `${apart} levels apart on average`); // it fades in
    apart = await distance(page, canvas, expected, pixels);
  }
  assert.equal(await page.textContent("h2"), NAME);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

/** How far the screen is from a picture at the centres of its pixels, on average; below lie Mirador's buttons. */
async function distance(page, canvas, { width, height }, pixels) {
  const [view] = await page.evaluate(() => Object.values(mirador.store.getState().viewers));
  const box = await canvas.boundingBox();
  if (!view || !box) return 256;
  const scale = box.width * view.zoom;
  const screen = readPng(await page.screenshot({ clip: box }));
  const found = rgba(screen);
  let sum = 0;
  let count = 0;
  for (let y = 0; y < height / 2; y++) {
    for (let x = 0; x < width; x++) {
      const column = Math.floor(box.width / 2 + (x + 0.5 - view.x) * scale);
      const row = Math.floor(box.height / 2 + (y + 0.5 - view.y) * scale);
      if (column < 0 || row < 0 || column >= screen.width || row >= screen.height) continue;
      for (let c = 0; c < 3; c++) sum += Math.abs(found[4 * (row * screen.width + column) + c] - pixels[4 * (y * width + x) + c]);
      count += 3;
    }
  }
  return count > 1.5 * (width / 2) * height ? sum / count : 256;
}
