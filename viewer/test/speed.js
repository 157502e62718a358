/** What a page takes: until the first picture, for each frame of a movement, and in long tasks of its main thread. */

import { pageOf, settled } from "./browser.js";

const WATCH = `
  globalThis.long = [];
  new PerformanceObserver((list) => long.push(...list.getEntries().map(({ duration }) => Math.round(duration)))).observe({ type: "longtask", buffered: true });
`;

/** A page that shows a file: {page, first, all}, milliseconds until something and until all of it is shown. */
export async function openTimed(browser, address, options) {
  const page = await pageOf(browser, address, { ...options, script: WATCH });
  const hasFirst = () => {
    const layer = globalThis.sgiViewer?.scene.layers[0];
    return layer?.tiles.get(`${layer.coarsest}/0/0`)?.bitmap;
  };
  await page.waitForFunction(hasFirst, null, { polling: 10 });
  const first = await page.evaluate(() => performance.now());
  await settled(page);
  return { page, first, all: await page.evaluate(() => performance.now()) };
}

/** Milliseconds of the main thread's tasks of more than 50, since the page began. */
export const longTasks = (page) => page.evaluate(() => globalThis.long);

/**
 * Moves the view frame by frame, from a scale on in the middle third: by pixels of the screen, or by a factor. Returns
 * {rate: frames a second, gaps: between frames, took: of the main thread for each}, in milliseconds.
 */
export async function moved(page, [start, zoom, pan], frames) {
  await page.evaluate((scale) => {
    const { scene } = sgiViewer;
    const side = (length) => length / scale;
    scene.move((camera) => camera.show({ x: camera.width / 3, y: camera.height / 3, width: side(camera.columns), height: side(camera.rows) }));
  }, start);
  await settled(page);
  const { times, took } = await page.evaluate(
    ([factor, step, count]) =>
      new Promise((resolve) => {
        const { scene } = sgiViewer;
        const times = [];
        const took = [];
        const draw = scene.draw;
        scene.draw = () => {
          const begin = performance.now();
          draw.call(scene);
          took.push(performance.now() - begin);
        };
        const tick = (now) => {
          times.push(now);
          if (times.length > count) {
            delete scene.draw;
            return resolve({ times, took });
          }
          scene.move((camera) => (step ? camera.pan(-step, -step / 2) : camera.zoom(factor)));
          requestAnimationFrame(tick);
        };
        requestAnimationFrame(tick);
      }),
    [zoom, pan, frames],
  );
  const gaps = times.slice(1).map((time, at) => time - times[at]).sort((a, b) => a - b);
  return { rate: (1000 * gaps.length) / (times.at(-1) - times[0]), gaps, took: took.sort((a, b) => a - b) };
}
