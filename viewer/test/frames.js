/** What a page shows frame after frame while the view changes. */

/**
 * Moves the camera to a scale, around the middle of the screen, and has what is asked for draw ("gpu", "cpu"). Waits
 * until all is drawn. Returns for each frame
 * {time: milliseconds since, contrast: mean difference of neighbouring pixels of the screen's middle}; the last one
 * is of the view when all is drawn.
 */
export function contrasts(page, scale, mode) {
  return page.evaluate(async ([to, by]) => {
    const SIDE = 200;
    const { scene } = sgiViewer;
    const copy = new OffscreenCanvas(SIDE, SIDE).getContext("2d", { willReadFrequently: true });
    const contrast = () => {
      const { width, height } = scene.canvas;
      copy.clearRect(0, 0, SIDE, SIDE);
      copy.drawImage(scene.canvas, (SIDE - width) >> 1, (SIDE - height) >> 1);
      const { data } = copy.getImageData(0, 0, SIDE, SIDE);
      let sum = 0;
      for (let at = 4; at < data.length; at += 4) if (at % (4 * SIDE)) sum += Math.abs(data[at + 1] - data[at - 3]);
      return sum / SIDE / (SIDE - 1);
    };
    const frames = [];
    const begin = performance.now();
    const note = () => frames.push({ time: Math.round(performance.now() - begin), contrast: contrast() });
    scene.addEventListener("drawn", note);
    scene.stage.choose(by);
    scene.move((camera) => camera.zoomTo(to));
    do await new Promise((wake) => setTimeout(wake, 20));
    while (!scene.isDone);
    scene.removeEventListener("drawn", note);
    note();
    return frames;
  }, [scale, mode]);
}
