/** <sgi-image> in a page, and <img> by the service worker. */

import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { pageOf, stand } from "./browser.js";
import { GOLDEN, decoded } from "./command.js";
import { farthest } from "./pixels.js";
import { readPng, rgba } from "./png.js";

const STREAM = join(GOLDEN, "rgb8-texture.sgi");

const site = stand();

/** Asserts that an element of the page looks as `sgi decode` draws the picture. */
async function looksLike(page, selector, ...options) {
  const expected = decoded(STREAM, ...options, "--no-dither");
  const found = readPng(await page.locator(selector).screenshot());
  assert.deepEqual([found.width, found.height], [expected.width, expected.height]);
  assert.ok(farthest(rgba(found), rgba(expected)) <= 1, selector);
}

const shows = (page, id, columns) =>
  page.waitForFunction(([name, count]) => document.getElementById(name).shadowRoot?.querySelector("canvas").width === count, [id, columns]);

test("sgi-image: its own size, sizes, a page's style", async (context) => {
  const page = await pageOf(site.browser, `${site.server.address}/images.html`);
  context.after(() => page.context().close());
  await shows(page, "own", 192);
  await shows(page, "sized", 96);
  await shows(page, "styled", 96);
  await looksLike(page, "#own");
  await looksLike(page, "#sized", "--scale", "1/2");
  await looksLike(page, "#styled", "--scale", "1/2");
  assert.equal(await page.getByRole("img", { name: "texture" }).count(), 3);
  await page.evaluate(() => (document.getElementById("styled").style.width = "384px"));
  await shows(page, "styled", 384);
  await looksLike(page, "#styled", "--scale", "2");
  await page.setViewportSize({ width: 480, height: 600 });
  await shows(page, "sized", 240);
  await looksLike(page, "#sized", "--scale", "1.25");
  assert.deepEqual(page.errors, []);
});

test("sgi-image: decoded where it is nearly in view, another src, a failure", async (context) => {
  const page = await pageOf(site.browser, `${site.server.address}/images.html`);
  context.after(() => page.context().close());
  await shows(page, "own", 192);
  assert.ok(!site.server.sent.has("/files/gray16.sgi"));
  await page.evaluate(() => scrollTo(0, 5000));
  await page.waitForFunction(() => document.getElementById("below").shown);
  assert.ok(site.server.sent.has("/files/gray16.sgi"));
  await page.evaluate(() => scrollTo(0, 0));
  await page.waitForFunction(() => !document.getElementById("absent").shadowRoot.querySelector("slot").hidden);
  assert.ok(await page.getByText("A picture that is not there").isVisible());
  const failure = await page.evaluate(
    () =>
      new Promise((resolve) => {
        const image = document.getElementById("own");
        image.addEventListener("error", ({ detail }) => resolve(detail));
        image.src = "/files/absent.sgi";
      }),
  );
  assert.equal(failure, "The server has no such file.");
  await page.evaluate(() => (document.getElementById("absent").src = "/files/rgb8-texture.sgi"));
  await shows(page, "absent", 192);
  await looksLike(page, "#absent");
  assert.deepEqual(page.errors, []);
});

test("img: the service worker answers with PNG, also what was asked for before it was there", async (context) => {
  const page = await pageOf(site.browser, `${site.server.address}/blank.html`);
  context.after(() => page.context().close());
  await page.setContent('<style>img { display: block; }</style><img id="whole" src="/files/rgb8-texture.sgi"><img id="half" src="/files/rgb8-texture.sgi?width=96"><img id="absent" src="/files/absent.sgi">');
  await page.evaluate(async () => (await import("/src/index.js")).showImages("/service_worker.js"));
  await page.waitForFunction(() => ["whole", "half"].every((id) => document.getElementById(id).naturalWidth));
  await looksLike(page, "#whole");
  await looksLike(page, "#half", "--scale", "1/2");
  assert.equal(await page.evaluate(() => document.getElementById("absent").naturalWidth), 0);
  assert.deepEqual(page.errors, []);
});
