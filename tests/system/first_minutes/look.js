/** Waits until Chromium shows all <sgi-image> of a page, and prints what it shows as JSON: node look.js URL OUT.png */

import { writeFileSync } from "node:fs";
import { launch, pageOf } from "../../../viewer/test/browser.js";

const [address, out] = process.argv.slice(2);
const browser = await launch();
const page = await pageOf(browser, address);
await page.waitForFunction(() => {
  const all = [...document.querySelectorAll("sgi-image")];
  return all.length && all.every((each) => each.shown);
});
const found = await page.evaluate(() =>
  [...document.querySelectorAll("sgi-image")].map(({ canvas, parentElement }) => ({
    width: canvas.hidden ? 0 : canvas.width,
    height: canvas.height,
    link: parentElement.href,
  })),
);
const first = await page.evaluate(() => document.querySelector("sgi-image").canvas.toDataURL());
writeFileSync(out, Buffer.from(first.split(",")[1], "base64"));
const viewer = await pageOf(browser, found[0].link);
await viewer.waitForFunction(() => globalThis.sgiViewer?.scene.layers.length && sgiViewer.scene.isDone);
const name = await viewer.textContent("#name");
console.log(JSON.stringify({ pictures: found, viewed: name, errors: [...page.errors, ...viewer.errors] }));
await browser.close();
