/** The page with WebGL2, which Chromium emulates here: what it draws, and what happens where it cannot. */

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { askedWhilePanning, launch, message, pageOf, settled, shot, show } from "./browser.js";
import { GOLDEN, PYTHON, ROOT, decoded } from "./command.js";
import { contrasts } from "./frames.js";
import { farthest, onBlack, part } from "./pixels.js";
import { rgba } from "./png.js";
import { serve } from "./server.js";

const VIEWS = [[4, 16, 8, 60, 40], [1, 3, 5, 70, 50], [2.5, 10, 6, 40, 30], [0.7, 0, 0, 80, 60], [0.25, 0, 0, 80, 60], [32, 20, 20, 20, 15]];
const NAMES = ["rgb8-texture", "rgb8-tiles-texture", "rgb8-tiles", "gray16-texture", "float", "paper-rgb8", "rgba8-tiles-luma"];
const SHARP = 0.7; // of the contrast of what stands still, that moving has at least
const RESTORED = ["rgb8-restored", "rgba8-tiles-restored", "gray16-restored"];

let browser, folder, server;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "sgi-files-"));
  for (const name of [...NAMES, ...RESTORED]) copyFileSync(join(GOLDEN, `${name}.sgi`), join(folder, `${name}.sgi`));
  const bytes = readFileSync(join(GOLDEN, "rgb8-tiles-texture.sgi"));
  const last = bytes.lastIndexOf("T");
  writeFileSync(join(folder, "scratched.sgi"), bytes.fill(bytes[last + 60] ^ 255, last + 60, last + 61));
  execFileSync(PYTHON, [join(ROOT, "viewer/test/hole.py"), join(folder, "hole.sgi")]);
  execFileSync(PYTHON, [join(ROOT, "viewer/test/mosaic.py"), join(folder, "mosaic.sgi")]);
  server = await serve({ "/files/": folder, "/": join(ROOT, "viewer/src") });
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.close();
  rmSync(folder, { recursive: true });
});

async function opened(name, { draw = "gpu", rest = "", ...options } = {}) {
  const page = await pageOf(browser, `${server.address}/?draw=${draw}&file=/files/${name}.sgi${rest}`, options);
  await settled(page);
  return page;
}

async function matches(page, name, [scale, ...region]) {
  const options = ["--region", region.join(","), "--scale", scale, "--no-dither"];
  const expected = decoded(join(folder, `${name}.sgi`), ...options);
  await show(page, region[0], region[1], scale);
  await page.evaluate(() => (document.body.style.background = "black"));
  const found = await shot(page, expected.width, expected.height);
  const most = farthest(found, onBlack(rgba(expected)));
  const allowed = expected.channels % 2 ? 1 : 2; // one of the colour, and one of alpha times the colour
  assert.ok(most <= allowed, `${name} at scale ${scale}: ${most} levels apart`);
}

const drawnBy = (page) => page.textContent("#drawing");

for (const name of NAMES.filter((one) => !one.startsWith("rgba"))) {
  test(`${name}: a region drawn by the GPU is what sgi decode draws, and moving asks no worker`, async () => {
    const page = await opened(name);
    await page.evaluate(() => {
      const { file } = sgiViewer.scene.decoder;
      const run = file.run.bind(file);
      globalThis.asked = [];
      file.run = (task, ...rest) => asked.push(task) && run(task, ...rest);
    });
    for (const view of name === NAMES[0] ? VIEWS : VIEWS.slice(2, 5)) {
      await matches(page, name, view);
      assert.equal(await drawnBy(page), "GPU");
    }
    assert.deepEqual(await page.evaluate(() => asked), []);
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
}

const hide = (what) => `{
  const get = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    if (kind !== "webgl2") return get.call(this, kind, options);
    if ("${what}" === "webgl2") return null;
    const context = get.call(this, kind, options);
    const extension = context.getExtension.bind(context);
    context.getExtension = (name) => (name === "${what}" ? null : extension(name));
    return context;
  };
}`;

const FALLBACKS = {
  "a picture with alpha": ["rgba8-tiles-luma", {}, /has alpha/, "CPU instead of GPU"],
  "a picture with pixels that hold nothing": ["hole", {}, /nodata/, "CPU instead of GPU"],
  "a GPU that is emulated, in auto": ["rgb8-texture", { draw: "auto" }, /no WebGL2 with a GPU/, "auto: CPU"],
  "no WebGL2": ["rgb8-texture", { script: hide("webgl2") }, /no WebGL2\./, "CPU instead of GPU"],
  "no buffers of floats": ["rgb8-texture", { script: hide("EXT_color_buffer_float") }, /EXT_color_buffer_float/, "CPU instead of GPU"],
  "no sums of floats": ["rgb8-texture", { script: hide("EXT_float_blend") }, /EXT_float_blend/, "CPU instead of GPU"],
  "who asks for it": ["rgb8-texture", { draw: "cpu" }, /as chosen/, "CPU"],
};
for (const [why, [name, options, reason, shown]] of Object.entries(FALLBACKS)) {
  test(`workers draw: ${why}`, async () => {
    const page = await opened(name, options);
    assert.equal(await drawnBy(page), shown);
    assert.match(await page.getAttribute("#drawing", "title"), reason);
    if (!name.startsWith("rgba")) await matches(page, name, VIEWS[2]);
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
}

test("workers draw what shows a great part of a picture at once", async () => {
  const page = await opened("rgb8-texture");
  await show(page, 0, 0, 0.2);
  assert.equal(await drawnBy(page), "CPU instead of GPU");
  assert.match(await page.getAttribute("#drawing", "title"), /^Workers draw: the scale is below 1\/4\./);
  await show(page, 0, 0, 1);
  assert.equal(await drawnBy(page), "GPU");
  assert.match(await page.getAttribute("#drawing", "title"), /^The GPU draws\./);
  await page.context().close();
});

for (const name of RESTORED) {
  test(`${name}: restored at scales from 1 on, on both sides of 1 and of 1/4`, async () => {
    const page = await opened(name);
    const isPlain = !name.startsWith("rgba");
    for (const scale of [0.9, 1, 2.5, 0.99, 4, 0.26, 0.24, 0.3, 1]) {
      await matches(page, name, [scale, 3, 5, 100, 100]);
      const by = !isPlain || scale < 0.25 ? "CPU instead of GPU" : scale < 1 ? "GPU" : "GPU, CPU";
      assert.equal(await drawnBy(page), by);
    }
    const title = await page.getAttribute("#drawing", "title");
    assert.match(title, isPlain ? /^The GPU draws a preview: workers restore/ : /has alpha/);
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
}

/** Whether all frames are about as sharp as the view when all is drawn, as which it begins. */
function assertSharp(frames, before, what) {
  const { contrast } = frames.at(-1);
  const least = Math.min(...frames.map((frame) => frame.contrast));
  assert.ok(contrast > 3);
  assert.ok(least >= SHARP * Math.min(before, contrast), `${what}: ${least} of ${contrast} and ${before} before`);
}

test("a large, restored file: no blurred frame where the GPU begins or ends to draw", async (context) => {
  const page = await opened("mosaic", { viewport: { width: 320, height: 280 } });
  let before = (await contrasts(page, 0.9)).at(-1).contrast;
  for (const [scale, by] of [[1.1, "GPU, CPU"], [0.9, "GPU"], [2, "GPU, CPU"], [0.26, "GPU"], [0.24, "CPU instead of GPU"], [0.3, "GPU"]]) {
    const frames = await contrasts(page, scale);
    context.diagnostic(`to scale ${scale}: ${frames.map(({ time, contrast }) => `${time} ms ${contrast.toFixed(1)}`).join(", ")}`);
    assertSharp(frames, before, `to scale ${scale}`);
    assert.equal(await drawnBy(page), by);
    before = frames.at(-1).contrast;
  }
  assertSharp(await contrasts(page, 0.3, "cpu"), before, "from the GPU to workers");
  assert.equal(await drawnBy(page), "CPU");
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test("workers alone: zooming out shows finer tiles until coarser ones are there", async () => {
  const page = await opened("mosaic", { draw: "cpu", viewport: { width: 320, height: 280 } });
  const before = (await contrasts(page, 1)).at(-1).contrast;
  assertSharp(await contrasts(page, 0.49), before, "to scale 0.49");
  await page.context().close();
});

test("restored squares move along with the preview", async () => {
  const page = await opened("rgb8-restored");
  await show(page, 0, 0, 4);
  const before = await shot(page, 400, 300);
  assert.deepEqual(await askedWhilePanning(page), []);
  const after = await shot(page, 400, 300);
  assert.equal(farthest(part(after, 400, 0, 320), part(before, 400, 64, 384)), 0);
  await page.context().close();
});

test("a key switches between both", async () => {
  const page = await opened("rgb8-tiles-texture");
  for (const shown of ["GPU", "CPU", "auto: GPU"]) {
    await settled(page);
    assert.equal(await drawnBy(page), shown);
    await matches(page, "rgb8-tiles-texture", VIEWS[2]);
    await page.keyboard.press("g");
    await page.waitForFunction((before) => document.querySelector("#drawing").textContent !== before, shown);
  }
  await page.context().close();
});

test("a GPU that is lost and comes back", async () => {
  const page = await opened("rgb8-texture");
  await matches(page, "rgb8-texture", VIEWS[2]);
  await page.evaluate(() => (globalThis.lost = sgiViewer.scene.stage.renderer.device.gl.getExtension("WEBGL_lose_context")).loseContext());
  await page.waitForFunction(() => sgiViewer.scene.drawnBy === "CPU");
  assert.match(await page.getAttribute("#drawing", "title"), /has taken the GPU away/);
  await matches(page, "rgb8-texture", VIEWS[0]);
  await page.evaluate(() => lost.restoreContext());
  await page.waitForFunction(() => sgiViewer.scene.drawnBy === "GPU");
  await matches(page, "rgb8-texture", VIEWS[2]);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test("a GPU that is slow is given up in auto", async () => {
  const page = await opened("rgb8-texture", { draw: "auto" });
  const found = await page.evaluate(() => {
    const { stage } = sgiViewer.scene;
    for (let frame = 0; frame < 12; frame++) stage.waited(33);
    const before = stage.isSlow;
    for (let frame = 0; frame < 12; frame++) stage.waited(36);
    return [before, stage.isSlow, stage.renderer, stage.reason];
  });
  assert.deepEqual(found, [false, true, null, "The GPU took too long for each frame."]);
  await page.context().close();
});

test("a GPU without room is given up", async () => {
  const script = `{
    const check = WebGL2RenderingContext.prototype.checkFramebufferStatus;
    WebGL2RenderingContext.prototype.checkFramebufferStatus = function (target) {
      return globalThis.full ? this.FRAMEBUFFER_INCOMPLETE_ATTACHMENT : check.call(this, target);
    };
  }`;
  const page = await opened("rgb8-texture", { script });
  assert.equal(await drawnBy(page), "GPU");
  await page.evaluate(() => (globalThis.full = true));
  await page.setViewportSize({ width: 700, height: 500 });
  await page.waitForFunction(() => sgiViewer.scene.drawnBy === "CPU");
  assert.match(await page.getAttribute("#drawing", "title"), /no buffer of floats of this size/);
  await matches(page, "rgb8-texture", VIEWS[2]);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test("a second picture, ellipses", async () => {
  const page = await opened("rgb8-texture", { rest: "&other=/files/rgb8-tiles-texture.sgi" });
  await show(page, 0, 0, 4);
  assert.equal(await drawnBy(page), "GPU");
  const [first, second] = ["rgb8-texture", "rgb8-tiles-texture"].map((name) =>
    rgba(decoded(join(folder, `${name}.sgi`), "--region", "0,0,190,120", "--scale", 4)),
  );
  const found = await shot(page, 760, 480);
  assert.ok(farthest(part(found, 760, 0, 380), part(first, 760, 0, 380)) <= 1);
  assert.ok(farthest(part(found, 760, 420, 760), part(second, 760, 420, 760)) <= 1);
  await page.keyboard.press("e");
  await settled(page);
  assert.ok(farthest(await shot(page, 380, 480), part(found, 760, 0, 380)) > 50);
  await page.context().close();
});

test("a damaged tile: the others are drawn, and a sentence", async () => {
  const page = await opened("scratched");
  await show(page, 0, 0, 4);
  assert.match(await message(page), /damaged/);
  assert.equal(await drawnBy(page), "GPU, CPU");
  const expected = rgba(decoded(join(folder, "rgb8-tiles-texture.sgi"), "--region", "0,0,40,100", "--scale", 4));
  assert.ok(farthest(await shot(page, 160, 400), expected) <= 1);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
