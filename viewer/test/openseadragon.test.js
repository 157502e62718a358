/** SgiTileSource in OpenSeadragon, on the demo's page. */

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { launch, pageOf, shot } from "./browser.js";
import { GOLDEN, PYTHON, ROOT, decoded } from "./command.js";
import { rgba } from "./png.js";
import { serve } from "./server.js";

const JPEG = 3; // levels on average: a picture moved by half a pixel is farther away

/** The pixels of an enlarged picture, each from the middle of its square of 4 × 4. */
const everyFourth = (pixels, width) =>
  Uint8ClampedArray.from({ length: pixels.length / 16 }, (_, at) => {
    const [x, y] = [(at >> 2) % (width / 4), Math.floor(at / width)];
    return pixels[4 * (width * (4 * y + 2) + 4 * x + 2) + (at & 3)];
  });

let browser, server, command, address;

before(async () => {
  server = await serve({ "/files/": GOLDEN, "/": join(ROOT, "viewer") });
  browser = await launch();
  command = spawn(PYTHON, ["-m", "sgicodec", "serve", GOLDEN, "--port", "0"], { stdio: ["ignore", "ignore", "pipe"] });
  const [line] = await once(command.stderr, "data");
  address = /http:\/\/[\d.]+:\d+/.exec(line)[0];
});

after(async () => {
  await browser?.close();
  await server?.close();
  command?.kill();
});

const drawn = () => globalThis.viewer?.world.getItemCount() === 1 && viewer.world.getItemAt(0).getFullyLoaded();

/** Leaves the picture alone on the page, and shows a region of it. */
const showAlone = (page, region) =>
  page.evaluate(({ x, y, width, height }) => {
    viewer.navigator?.element.remove();
    document.querySelectorAll(".openseadragon-container > div:not(.openseadragon-canvas)").forEach((part) => part.remove());
    viewer.viewport.fitBounds(viewer.world.getItemAt(0).imageToViewportRectangle(x, y, width, height), true);
  }, region);

/** The mean difference of two pictures' samples. */
const apart = (found, expected) => found.reduce((sum, value, at) => sum + Math.abs(value - expected[at]), 0) / found.length;

test("a stream in OpenSeadragon, beyond its own pixels", async () => {
  const page = await pageOf(browser, `${server.address}/demo/openseadragon.html?file=/files/rgb8-texture.sgi`);
  await page.waitForFunction(drawn, null, { polling: 50 });
  const size = await page.evaluate(() => viewer.world.getItemAt(0).getContentSize());
  assert.deepEqual([size.x, size.y], [192, 128]);
  await showAlone(page, { x: 20, y: 10, width: 100, height: 75 }); // at 8 pixels for each
  const sharp = () => viewer.world.getItemAt(0).viewer.world.getItemAt(0).lastDrawn.every(({ tile }) => tile.level === 3 && tile.opacity === 1) && viewer.world.getItemAt(0).getFullyLoaded();
  await page.waitForFunction(sharp, null, { polling: 50 });
  const expected = rgba(decoded(join(GOLDEN, "rgb8-texture.sgi"), "--region", "20,10,100,75", "--scale", 8));
  const mean = apart(await shot(page, 800, 600), expected);
  assert.ok(mean < 0.5, `${mean} levels apart on average`);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test("the demo's page of an installed package", async () => {
  const folder = mkdtempSync(join(tmpdir(), "sgi-package-"));
  const npm = (...args) => execFileSync("npm", [...args, "--silent"], { cwd: folder }).toString().trim();
  const packed = ["viewer", "viewer/node_modules/openseadragon"].map((from) => npm("pack", "--ignore-scripts", join(ROOT, from)));
  npm("install", "--offline", "--no-audit", "--no-fund", ...packed.map((name) => `./${name}`));
  const installed = await serve({ "/files/": GOLDEN, "/": folder });
  const place = "/node_modules/sgi-viewer/demo/openseadragon.html?file=/files/rgb8-texture.sgi";
  const page = await pageOf(browser, `${installed.address}${place}`);
  await page.waitForFunction(drawn, null, { polling: 50 });
  assert.ok(installed.sent.has("/node_modules/openseadragon/build/openseadragon/openseadragon.min.js"));
  assert.ok(installed.sent.has("/node_modules/sgi-viewer/src/wasm/sgi.wasm"));
  assert.deepEqual(page.errors, []);
  await page.context().close();
  await installed.close();
  rmSync(folder, { recursive: true });
});

test("what cannot be opened", async () => {
  const page = await pageOf(browser, `${server.address}/demo/openseadragon.html?file=/files/absent.sgi`);
  await page.waitForSelector(".openseadragon-message");
  assert.match(await page.textContent(".openseadragon-message"), /no such file/);
  await page.context().close();
});

for (const place of ["/iiif/3/rgb8-texture.sgi/info.json", "/dzi/rgb8-texture.sgi.dzi"]) {
  test(`what sgi serve draws, in OpenSeadragon: ${place}`, async () => {
    const page = await pageOf(browser, `${server.address}/demo/openseadragon.html?file=/files/rgb8.sgi`);
    await page.waitForFunction(drawn, null, { polling: 50 });
    await page.evaluate((url) => viewer.open(url), `${address}${place}`);
    await page.waitForFunction(
      () => {
        const item = viewer.world.getItemAt(0);
        return item && !("decoder" in item.source) && item.lastDrawn.length > 0;
      },
      null,
      { polling: 50 },
    );
    await page.waitForFunction(drawn, null, { polling: 50 });
    const size = await page.evaluate(() => viewer.world.getItemAt(0).getContentSize());
    assert.deepEqual([size.x, size.y], [192, 128]);
    await page.evaluate(() => viewer.drawer.setImageSmoothingEnabled(false)); // one colour for each pixel
    await showAlone(page, { x: 0, y: 0, width: 200, height: 150 }); // at 4 pixels for each
    await page.waitForFunction(() => viewer.world.getItemAt(0).lastDrawn.every(({ tile }) => tile.opacity === 1), null, { polling: 50 });
    await page.waitForFunction(drawn, null, { polling: 50 });
    const expected = rgba(decoded(join(GOLDEN, "rgb8-texture.sgi")));
    const mean = apart(everyFourth(await shot(page, 768, 512), 768), expected);
    assert.ok(mean < JPEG, `${mean} levels apart on average`);
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
}
