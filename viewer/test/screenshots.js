/** Draws the pictures of the documentation: node test/screenshots.js LARGE.sgi SLIDE.sgi SEEDS.sgi PHOTO.sgi PHOTO.png */

import { dirname, basename, join } from "node:path";
import { launch, pageOf, settled } from "./browser.js";
import { ROOT } from "./command.js";
import { serve } from "./server.js";

const SIZE = { width: 960, height: 640 };
const [large, slide, seeds, photo, original] = process.argv.slice(2);
const folders = { "/large/": dirname(large), "/slide/": dirname(slide), "/seeds/": dirname(seeds), "/photo/": dirname(photo), "/original/": dirname(original), "/": join(ROOT, "viewer/src") };
const server = await serve(folders);
const browser = await launch();

async function picture(name, query, colorScheme, prepare) {
  const page = await pageOf(browser, `${server.address}/?${query}`, { viewport: SIZE, colorScheme });
  await settled(page);
  await page.mouse.move(500, 300);
  await prepare?.(page);
  await settled(page);
  await page.evaluate(() => document.activeElement.blur());
  await page.screenshot({ path: join(ROOT, "docs/images", `viewer-${name}.jpg`), type: "jpeg", quality: 88 });
  await page.context().close();
}

const show = (page, region) => page.evaluate((box) => sgiViewer.scene.move((camera) => camera.show(box)), region);

await picture("large", `file=/large/${basename(large)}`, "dark");
await picture("slide", `file=/slide/${basename(slide)}`, "light");
await picture("ellipses", `file=/seeds/${basename(seeds)}`, "light", async (page) => {
  await show(page, { x: 132, y: 218, width: 60, height: 36 });
  await settled(page);
  await page.click("#ellipses");
  await page.mouse.move(500, 300);
});
await picture("compare", `file=/photo/${basename(photo)}&other=/original/${basename(original)}`, "dark", (page) =>
  show(page, { x: 430, y: 90, width: 240, height: 146 }),
);
await browser.close();
await server.close();
