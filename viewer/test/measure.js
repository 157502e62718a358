/** Prints what the viewer takes on this machine: node test/measure.js [FILE.sgi [FRAMES [WIDTHxHEIGHT]]].
 *
 * The file is by default one of 151 megapixels.
 */

import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { launch } from "./browser.js";
import { PYTHON, ROOT } from "./command.js";
import { serve } from "./server.js";
import { longTasks, moved, openTimed } from "./speed.js";

const folder = mkdtempSync(join(tmpdir(), "sgi-measure-"));
const file = process.argv[2] || join(folder, "mosaic.sgi");
const [width, height] = (process.argv[4] ?? "1280x800").split("x").map(Number);
if (!process.argv[2]) execFileSync(PYTHON, [join(ROOT, "viewer/test/mosaic.py"), file]);
const server = await serve({ "/files/": dirname(file), "/": join(ROOT, "viewer/src") });
const browser = await launch();
const address = `${server.address}/?file=/files/${basename(file)}`;
const { page, first, all } = await openTimed(browser, address, { viewport: { width, height } });
const size = statSync(file).size;
const bytes = server.sent.get(`/files/${basename(file)}`);
console.log(`first picture ${Math.round(first)} ms, all of it ${Math.round(all)} ms after the page began`);
console.log(`bytes of the first view: ${bytes} of ${size} (${((100 * bytes) / size).toFixed(2)} %)`);

const moves = { "pan at 1:1": [1, 1, 6], "zoom 1/8 to 8": [1 / 8, 1.035, 0], "pan at 16:1": [16, 1, 6] };
for (const [name, move] of Object.entries(moves)) {
  const { rate, gaps, took } = await moved(page, move, Number(process.argv[3] ?? 120));
  console.log(`${name}: ${took[took.length >> 1].toFixed(1)} ms of the main thread for each frame`);
  console.log(`${name}: ${rate.toFixed(0)} frames a second, slowest frame ${gaps.at(-1).toFixed(0)} ms, 95 % within ${gaps[Math.floor(0.95 * gaps.length)].toFixed(0)} ms`);
}
const long = await longTasks(page);
console.log(`tasks of more than 50 ms on the main thread: ${long.length ? long.join(", ") + " ms" : "none"}`);
console.log(`pictures are drawn by ${await page.evaluate(() => sgiViewer.scene.decoder.file.pool.workers.length)} workers`);

await browser.close();
await server.close();
rmSync(folder, { recursive: true });
