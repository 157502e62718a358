/** What the page has around the picture: divider, names, difference, address, scale bar, help. */

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { launch, pageOf, settled, shot, show } from "./browser.js";
import { GOLDEN, PYTHON, ROOT, decode, decoded } from "./command.js";
import { farthest, part } from "./pixels.js";
import { readPng, rgba } from "./png.js";
import { serve } from "./server.js";
import { HELP } from "../src/help.js";

const [FIRST, SECOND] = ["rgb8-texture.sgi", "rgb8-tiles.png"]; // 192×128 pixels each
const BOTH = `/?file=/files/${FIRST}&other=/files/${SECOND}`;

let browser, folder, server;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "sgi-page-"));
  copyFileSync(join(GOLDEN, FIRST), join(folder, FIRST));
  decode(join(GOLDEN, "rgb8-tiles.sgi"), join(folder, SECOND));
  execFileSync(PYTHON, [join(ROOT, "viewer/test/measured.py"), folder]);
  server = await serve({ "/files/": folder, "/": join(ROOT, "viewer/src") });
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.close();
  rmSync(folder, { recursive: true });
});

async function opened(path, options) {
  const page = await pageOf(browser, `${server.address}${path}`, options);
  await settled(page);
  return page;
}

const camera = (page) => page.evaluate(() => ({ x: sgiViewer.scene.camera.x, y: sgiViewer.scene.camera.y, scale: sgiViewer.scene.camera.scale }));
const pixelsOf = (name) => rgba(name.endsWith(".sgi") ? decoded(join(folder, name)) : readPng(readFileSync(join(folder, name))));

test("the wheel zooms over the divider", async () => {
  const page = await opened(BOTH);
  const { x, y, width } = await page.locator("#divider").boundingBox();
  const before = await camera(page);
  await page.mouse.move(x + width / 2, y + 200);
  await page.mouse.wheel(0, -300);
  assert.ok((await camera(page)).scale > 1.5 * before.scale);
  await page.context().close();
});

test("each side has the name of its file, beside the divider", async () => {
  const page = await opened(BOTH);
  assert.deepEqual(await page.locator(".side").allTextContents(), [FIRST, SECOND]);
  const divider = await page.locator("#divider").boundingBox();
  const middle = divider.x + divider.width / 2;
  const [left, right] = [await page.locator("#left").boundingBox(), await page.locator("#right").boundingBox()];
  assert.ok(Math.abs(left.x + left.width - middle) < 1 && Math.abs(right.x - middle) < 1);
  await page.click("#compare");
  assert.deepEqual([await page.isVisible("#left"), await page.isVisible("#right")], [false, false]);
  await page.context().close();
});

test("f flips between both pictures", async () => {
  const page = await opened(BOTH);
  await show(page, 0, 0, 1);
  for (const name of [FIRST, SECOND, FIRST]) {
    await page.keyboard.press("f");
    await settled(page);
    const [found, expected] = [await shot(page, 192, 128), pixelsOf(name)].map((pixels) => part(pixels, 192, 4, 192)); // beside the divider
    assert.ok(farthest(found, expected) <= (name === FIRST ? 1 : 0), `${name}: ${farthest(found, expected)}`);
  }
  await page.context().close();
});

test("x shows the difference, amplified by a factor that is shown", async () => {
  const page = await opened(BOTH);
  await show(page, 0, 0, 1);
  const [first, second] = [pixelsOf(FIRST), pixelsOf(SECOND)];
  await page.keyboard.press("x");
  for (const [key, factor] of [[null, 8], ["[", 4], ["]", 8], ["]", 16], ["]", 32], ["]", 32]]) {
    if (key) await page.keyboard.press(key);
    await settled(page);
    assert.equal(await page.textContent("#left"), `${factor} × the difference of ${FIRST} and ${SECOND}`);
    const expected = first.map((value, at) => (at % 4 === 3 ? 255 : Math.min(255, factor * Math.abs(value - second[at]))));
    const found = await shot(page, 192, 128);
    assert.ok(farthest(found, expected) <= factor, `${farthest(found, expected)} levels at ${factor}`); // the stream: a level
    assert.ok(found.some((value, at) => at % 4 < 3 && value > 10 * 8));
  }
  assert.equal(await page.isVisible("#divider"), false);
  await page.click("#difference");
  await settled(page);
  assert.equal(await page.textContent("#left"), FIRST);
  assert.ok(await page.isVisible("#divider"));
  await page.click("#compare");
  assert.ok(await page.isDisabled("#difference"));
  await page.keyboard.press("x");
  assert.equal(await page.evaluate(() => sgiViewer.scene.difference), 0);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test("the address follows the view, and brings it back", async () => {
  const page = await opened(`/?file=/files/${FIRST}`);
  assert.equal(new URL(page.url()).hash, "");
  await show(page, 30, 20.25, 8);
  await page.waitForURL(/#/);
  const view = await camera(page);
  assert.equal(new URL(page.url()).hash, `#${view.x},${view.y.toFixed(2)},8`);
  const other = await opened(page.url().slice(server.address.length));
  const { x, y, scale } = await camera(other);
  assert.ok(x === view.x && Math.abs(y - view.y) < 0.006 && scale === 8, `${x}, ${y}, ${scale}`);
  await other.evaluate(() => (location.hash = "#96,64,2"));
  await other.waitForFunction(() => sgiViewer.scene.camera.scale === 2);
  assert.deepEqual(await camera(other), { x: 96, y: 64, scale: 2 });
  await other.keyboard.press("0");
  await other.waitForFunction(() => location.hash === "");
  assert.ok(other.url().endsWith(`?file=/files/${FIRST}`));
  for (const each of [page, other]) await each.context().close();
});

test("an address that names no view shows the whole picture", async () => {
  const [plain, odd] = [await opened(`/?file=/files/${FIRST}`), await opened(`/?file=/files/${FIRST}#1,2,nothing`)];
  assert.deepEqual(await camera(odd), await camera(plain));
  for (const each of [plain, odd]) await each.context().close();
});

for (const [name, expected] of [[FIRST, "10 px"], ["metres.sgi", "100 m"], ["aperio.sgi", "5 µm"]]) {
  test(`the scale bar of ${name}`, async () => {
    const page = await opened(`/?file=/files/${name}`);
    await show(page, 0, 0, 10);
    assert.equal(await page.textContent("#bar"), expected);
    const { width } = await page.locator("#bar").boundingBox();
    const each = { [FIRST]: 1, "metres.sgi": 10, "aperio.sgi": 0.504 }[name];
    assert.ok(Math.abs(width - (10 * parseInt(expected)) / each) < 0.1, `${width}`);
    await page.context().close();
  });
}

test("? opens the help, which names every key", async () => {
  const page = await opened(`/?file=/files/${FIRST}`);
  assert.equal(await page.isVisible("#help"), false);
  await page.keyboard.press("?");
  assert.deepEqual(await page.locator("#help th").allTextContents(), HELP.map(([keys]) => keys));
  await page.keyboard.press("?");
  assert.equal(await page.isVisible("#help"), false);
  await page.click("#ask");
  await page.keyboard.press("Escape");
  assert.equal(await page.isVisible("#help"), false);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
