/** Prints what the viewer takes on this machine: node test/measure.js [FILE.sgi [gpu [FRAMES [WIDTHxHEIGHT]]]].
 *
 * The file is by default one of 151 megapixels, which workers draw. Where Chromium emulates the GPU, frames of "gpu" say
 * nothing about one; what the main thread takes for each does.
 */

import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { launch, pageOf, settled } from "./browser.js";
import { PYTHON, ROOT } from "./command.js";
import { serve } from "./server.js";

const WATCH = () => {
  globalThis.long = [];
  new PerformanceObserver((list) => long.push(...list.getEntries().map((entry) => Math.round(entry.duration)))).observe({ type: "longtask", buffered: true });
};

const folder = mkdtempSync(join(tmpdir(), "sgi-measure-"));
const file = process.argv[2] || join(folder, "mosaic.sgi");
const draw = process.argv[3] ?? "cpu";
const [width, height] = (process.argv[5] ?? "1280x800").split("x").map(Number);
if (!process.argv[2]) execFileSync(PYTHON, [join(ROOT, "viewer/test/mosaic.py"), file]);
const server = await serve({ "/files/": dirname(file), "/": join(ROOT, "viewer/src") });
const browser = await launch();
const page = await pageOf(browser, `${server.address}/?file=/files/none.sgi`, { viewport: { width, height } });

await page.addInitScript(WATCH);
await page.goto(`${server.address}/?draw=${draw}&file=/files/${basename(file)}`);
await page.waitForFunction(() => globalThis.sgiViewer?.scene.layers[0]?.tiles.get(`${sgiViewer.scene.layers[0].coarsest}/0/0`)?.bitmap, null, { polling: 10 });
const first = await page.evaluate(() => performance.now());
await settled(page);
const settledAt = await page.evaluate(() => performance.now());
const size = statSync(file).size;
const bytes = server.sent.get(`/files/${basename(file)}`);
console.log(`first picture ${Math.round(first)} ms, all of it ${Math.round(settledAt)} ms after the page began`);
console.log(`bytes of the first view: ${bytes} of ${size} (${((100 * bytes) / size).toFixed(2)} %)`);

const moves = { "pan at 1:1": [1, 1, 6], "zoom 1/8 to 8": [1 / 8, 1.035, 0], "pan at 16:1": [16, 1, 6] };
for (const [name, [scale, factor, step]] of Object.entries(moves)) {
  const { times: found, took, by } = await page.evaluate(
    ([start, zoom, pan, frames]) =>
      new Promise((resolve) => {
        const { scene } = sgiViewer;
        scene.move((camera) => camera.show({ x: camera.width / 3, y: camera.height / 3, width: camera.columns / start, height: camera.rows / start }));
        const times = [];
        const took = [];
        const drawn = scene.draw.bind(scene);
        scene.draw = () => {
          const begin = performance.now();
          drawn();
          took.push(performance.now() - begin);
        };
        const tick = (now) => {
          times.push(now);
          if (times.length > frames) return resolve({ times, took, by: scene.drawnBy });
          scene.move((camera) => (pan ? camera.pan(-pan, -pan / 2) : camera.zoom(zoom)));
          requestAnimationFrame(tick);
        };
        setTimeout(() => requestAnimationFrame(tick), 3000);
      }),
    [scale, factor, step, Number(process.argv[4] ?? 120)],
  );
  const gaps = found.slice(1).map((time, at) => time - found[at]);
  gaps.sort((a, b) => a - b);
  const rate = (1000 * gaps.length) / (found.at(-1) - found[0]);
  took.sort((a, b) => a - b);
  console.log(`${name}, drawn by ${by}: ${took[took.length >> 1].toFixed(1)} ms of the main thread for each frame`);
  console.log(`${name}: ${rate.toFixed(0)} frames a second, slowest frame ${gaps.at(-1).toFixed(0)} ms, 95 % within ${gaps[Math.floor(0.95 * gaps.length)].toFixed(0)} ms`);
}
const long = await page.evaluate(() => globalThis.long);
console.log(`tasks of more than 50 ms on the main thread: ${long.length ? long.join(", ") + " ms" : "none"}`);
console.log(`pictures are drawn by ${await page.evaluate(() => sgiViewer.scene.decoder.pool.workers.length)} workers`);

await browser.close();
await server.close();
rmSync(folder, { recursive: true });
