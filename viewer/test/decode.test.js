/** decode() in pages, in workers and in Node. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { test } from "node:test";
import { decode } from "../src/node.js";
import { pageOf, stand } from "./browser.js";
import { GOLDEN, decoded } from "./command.js";
import { farthest } from "./pixels.js";
import { rgba } from "./png.js";

const NAME = "rgb8-texture.sgi";
const half = () => decoded(join(GOLDEN, NAME), "--scale", "1/2", "--no-dither");

const site = stand();

test("Node: a path, a URL, bytes", async () => {
  const path = join(GOLDEN, NAME);
  for (const source of [path, pathToFileURL(path), `${site.server.address}/files/${NAME}`, readFileSync(path)]) {
    const { width, height, data } = await decode(source, { width: 96 });
    assert.deepEqual([width, height], [96, 64]);
    assert.ok(farthest(data, rgba(half())) <= 1);
  }
  assert.equal((await decode(path)).width, 192);
  await assert.rejects(decode(Buffer.from("nothing of a stream")), { name: "SgiError", message: /^[A-Z].*\.$/ });
});

for (const place of ["page", "worker"]) {
  test(`a ${place}: an ImageBitmap of a width`, async (context) => {
    const page = await pageOf(site.browser, `${site.server.address}/blank.html`);
    context.after(() => page.context().close());
    const bitmap = page.evaluate(
      async ([name, isPage]) => {
        let bitmap;
        if (isPage) bitmap = await (await import("/src/index.js")).decode(name, { width: 96 });
        else {
          const worker = new Worker("/asking_worker.js", { type: "module" });
          bitmap = await new Promise((resolve) => {
            worker.onmessage = ({ data }) => resolve(data);
            worker.postMessage(name);
          });
        }
        const drawing = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
        drawing.drawImage(bitmap, 0, 0);
        return [bitmap.width, bitmap.height, [...drawing.getImageData(0, 0, bitmap.width, bitmap.height).data]];
      },
      [`/files/${NAME}`, place === "page"],
    );
    const [width, height, pixels] = await bitmap;
    assert.deepEqual([width, height], [96, 64]);
    assert.ok(farthest(pixels, rgba(half())) <= 1);
    assert.deepEqual(page.errors, []);
  });
}

test("a page with 24 pictures has as many workers as processors, at most four, and ends them", async (context) => {
  const script = `{
    globalThis.workers = 0;
    const Made = globalThis.Worker;
    globalThis.Worker = class extends Made {
      constructor(...all) { super(...all); workers++; }
      terminate() { super.terminate(); workers--; }
    };
    const wait = setTimeout;
    globalThis.setTimeout = (work, time, ...rest) => wait(work, time === 10_000 ? 200 : time, ...rest);
  }`;
  const page = await pageOf(site.browser, `${site.server.address}/blank.html`, { script });
  context.after(() => page.context().close());
  const [most, widths] = await page.evaluate(async (names) => {
    const { decode } = await import("/src/index.js");
    const all = names.map((name) => decode(name, { width: 48 }));
    const bitmaps = await Promise.all(all);
    return [workers, bitmaps.map(({ width }) => width)];
  }, Array.from({ length: 24 }, (_, at) => `/files/${["rgb8-texture", "gray16", "rgb8-tiles-texture"][at % 3]}.sgi`));
  assert.ok(most >= 1 && most <= 4, `${most} workers`);
  assert.deepEqual(widths, Array(24).fill(48));
  await page.waitForFunction(() => workers === 0);
  const again = await page.evaluate(async (name) => (await (await import("/src/index.js")).decode(name)).width, `/files/${NAME}`);
  assert.equal(again, 192);
  assert.deepEqual(page.errors, []);
});

test("a file that cannot be decoded: a sentence, and the others come", async (context) => {
  const page = await pageOf(site.browser, `${site.server.address}/blank.html`);
  context.after(() => page.context().close());
  const found = await page.evaluate(async (names) => {
    const { decode } = await import("/src/index.js");
    const all = await Promise.allSettled(names.map((name) => decode(name)));
    return all.map(({ value, reason }) => value?.width ?? reason.message);
  }, ["/files/absent.sgi", "/blank.html", `/files/${NAME}`]);
  assert.deepEqual(found, ["The server has no such file.", "The file is no .sgi stream, and no picture that this browser can show.", 192]);
});

test("a worker that ends without a word: a sentence, and another one takes its place", async (context) => {
  const script = `{
    const Made = globalThis.Worker;
    globalThis.Worker = class extends Made {
      postMessage(...all) {
        if (globalThis.isBroken || all[0].task !== "draw") return super.postMessage(...all);
        globalThis.isBroken = true;
        this.onerror({});
      }
    };
  }`;
  const page = await pageOf(site.browser, `${site.server.address}/blank.html`, { script });
  context.after(() => page.context().close());
  const found = await page.evaluate(async (name) => {
    const { decode } = await import("/src/index.js");
    const first = await decode(name).catch(({ message }) => message);
    return [first, (await decode(name)).width];
  }, `/files/${NAME}`);
  assert.deepEqual(found, ["The decoder ended without a word; there may be too little memory.", 192]);
});

test("servers and Node can load what pages import", async () => {
  for (const name of ["index", "element", "sgi_tile_source"]) await import(`../src/${name}.js`);
});
