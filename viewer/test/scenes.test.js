/** Many scenes on a page. */

import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { pageOf, stand } from "./browser.js";
import { GOLDEN, decoded } from "./command.js";
import { farthest } from "./pixels.js";
import { rgba } from "./png.js";

const site = stand();

test("24 scenes: each shows its picture", async (context) => {
  const page = await pageOf(site.browser, `${site.server.address}/scenes.html`);
  context.after(() => page.context().close());
  await page.waitForFunction(() => globalThis.scenes?.every((scene) => scene.isDone), null, { polling: 50 });
  const expected = ["1/2", "1"].map((scale) => rgba(decoded(join(GOLDEN, "rgb8-texture.sgi"), "--scale", scale, "--no-dither")));
  const found = await page.evaluate(() => scenes.map(({ context, canvas }) => [...context.getImageData(0, 0, canvas.width, canvas.height).data]));
  assert.equal(found.length, 24);
  for (const [at, pixels] of found.entries()) assert.ok(farthest(pixels, expected[at % 2]) <= 1);
  assert.deepEqual(page.errors, []);
});
