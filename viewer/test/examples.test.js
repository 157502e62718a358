/** The page that examples/time_series.py makes; tests/system/first_minutes/ looks at that of examples/web_gallery.py. */

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { pageOf, settled, stand } from "./browser.js";
import { PYTHON, ROOT } from "./command.js";
import { serve } from "./server.js";

const site = stand();

test("a time series: the slider leafs through the dates, each with a link to the viewer", async (context) => {
  const folder = mkdtempSync(join(tmpdir(), "sgi-series-"));
  context.after(() => rmSync(folder, { recursive: true }));
  execFileSync(PYTHON, [join(ROOT, "viewer/test/measured.py"), folder]);
  const scenes = ["2026-06-02=metres.sgi", "2026-05-01=turned.sgi"].map((each) => each.replace(".sgi", ".tif"));
  for (const each of ["metres", "turned"]) {
    execFileSync(PYTHON, ["-m", "sgicodec", "decode", `${each}.sgi`, `${each}.tif`, "--quiet"], { cwd: folder });
  }
  execFileSync(PYTHON, [join(ROOT, "examples/time_series.py"), ...scenes, "--out", "made"], { cwd: folder, stdio: "ignore" });
  const server = await serve({ "/viewer/": join(folder, "made/viewer"), "/": join(folder, "made") });
  const page = await pageOf(site.browser, `${server.address}/`);
  context.after(async () => {
    await page.context().close();
    await server.close();
  });
  const rows = JSON.parse(readFileSync(join(folder, "made/index.json")));
  assert.deepEqual(rows.map(({ date }) => date), ["2026-05-01", "2026-06-02"]);
  for (const [number, { date, stream, bytes }] of rows.entries()) {
    await page.fill("#when", String(number));
    await page.waitForFunction((src) => document.querySelector("sgi-image").shown === src, stream);
    assert.equal(await page.textContent("#date"), `${date}, ${(bytes / 1000).toFixed(1)} kB`);
  }
  await page.click("#date");
  await settled(page);
  assert.equal(await page.textContent("#name"), "2026-06-02.sgi");
  assert.match(await page.textContent("#bar"), / m$/);
  assert.deepEqual(page.errors, []);
});
