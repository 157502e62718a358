/** The outlines of Gaussians: each ellipse lies one standard deviation from the centre.
 *
 * A worker draws them for a view, thousands of lines; until the next view stands still, its picture moves along.
 */

import { Camera } from "./camera.js";

const NUMBERS = 5; // x, y, half axes a and b in pixels, angle

/** What the screen shows of them, an ImageBitmap. place: of the picture's corner on the screen, and the scale. */
export function outlines({ shapes, count }, { left, top, scale, columns, rows }) {
  const canvas = new OffscreenCanvas(columns, rows);
  const context = canvas.getContext("2d");
  context.setTransform(scale, 0, 0, scale, left, top);
  context.beginPath();
  for (let at = 0; at < count * NUMBERS; at += NUMBERS) {
    const [x, y, a, b, angle] = shapes.subarray(at, at + NUMBERS);
    context.moveTo(x + a * Math.cos(angle), y + a * Math.sin(angle));
    context.ellipse(x, y, a, b, angle, 0, 2 * Math.PI);
  }
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.lineWidth = 3;
  context.strokeStyle = "rgb(0 0 0 / 35%)";
  context.stroke();
  context.lineWidth = 1;
  context.strokeStyle = "rgb(255 230 80 / 90%)";
  context.stroke();
  return canvas.transferToImageBitmap();
}

/** The ellipses of the last view that stood still. */
export class Ellipses {
  /** changed(): there is more to draw; failed(error): there are none. */
  constructor(changed, failed) {
    Object.assign(this, { changed, failed });
    this.bitmap = this.camera = null; // what a worker drew, and for which view
    this.count = 0; // that are drawn
    this.total = 0; // that there are; null: too many to read
    this.asked = this.answered = ""; // views
  }

  /** Whether a view has what it can have. */
  isDone(camera) {
    return this.answered === camera.key;
  }

  async ask(decoder, camera) {
    const { key } = camera;
    if (this.asked === key) return;
    this.asked = key;
    const [left, top] = camera.toScreen(0, 0);
    const { scale, columns, rows } = camera;
    const view = Object.assign(new Camera(), camera);
    try {
      const found = await decoder.ellipses(camera.seen, { left, top, scale, columns, rows });
      this.answer(key, view, found ?? { bitmap: null, count: 0, total: null });
    } catch (error) {
      if (error.name === "AbortError") return;
      this.answer(key, view, { bitmap: null, count: 0, total: 0 });
      this.failed(error);
    }
    this.changed();
  }

  answer(key, camera, { bitmap, count, total }) {
    if (this.asked !== key) return bitmap?.close();
    this.bitmap?.close();
    Object.assign(this, { bitmap, camera, count, total, answered: key });
  }

  draw(context, camera) {
    if (!this.bitmap) return;
    const [left, top] = camera.toScreen(...this.camera.toPicture(0, 0));
    const factor = camera.scale / this.camera.scale;
    context.drawImage(this.bitmap, left, top, this.bitmap.width * factor, this.bitmap.height * factor);
  }

  close() {
    this.asked = "";
    this.bitmap?.close();
    this.bitmap = null;
  }
}
