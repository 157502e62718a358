/** A view as workers draw it at its own scale and place, in squares. What was drawn before moves along meanwhile. */

import { Camera } from "./camera.js";

const SIDE = 256; // screen pixels
const MOST_VIEWS = 3; // that are kept at a time
const PRIORITY = 1000; // after all tiles

export class Cells {
  /** changed(): there is more to draw; lost(error): a square cannot be. */
  constructor(decoder, changed, lost) {
    Object.assign(this, { decoder, changed, lost });
    this.views = []; // {camera, parts: [{column, row, bitmap or failed, job}]} of one scale, the newest last
  }

  /** Whether the newest view is what the camera shows. */
  isOf(camera) {
    return this.views.at(-1)?.camera.key === camera.key;
  }

  get isDone() {
    return (this.views.at(-1)?.parts ?? []).every(({ bitmap, failed }) => bitmap || failed);
  }

  /** Asks for what the camera shows. */
  ask(camera) {
    if (this.isOf(camera)) return;
    const last = this.views.at(-1);
    for (const { job } of last?.parts ?? []) job.cancel();
    if (last && !last.parts.some(({ bitmap }) => bitmap)) this.views.pop();
    while (this.views.length >= MOST_VIEWS) close(this.views.shift());
    const view = { camera: Object.assign(new Camera(), camera), parts: [] };
    this.views.push(view);
    const { width, height } = this.decoder.info;
    const [left, top] = camera.toScreen(0, 0);
    const [right, bottom] = camera.toScreen(width, height);
    const [first, end] = [Math.max(0, Math.ceil(left - 0.5)), Math.min(camera.columns, Math.ceil(right - 0.5))];
    const [above, below] = [Math.max(0, Math.ceil(top - 0.5)), Math.min(camera.rows, Math.ceil(bottom - 0.5))];
    for (let row = above; row < below; row += SIDE) {
      for (let column = first; column < end; column += SIDE) {
        this.askPart(view, column, row, Math.min(SIDE, end - column), Math.min(SIDE, below - row));
      }
    }
  }

  askPart(view, column, row, columns, rows) {
    const { camera } = view;
    const [x, y] = camera.toPicture(column, row);
    const size = { width: columns / camera.scale, height: rows / camera.scale };
    const part = { column, row, bitmap: null, failed: false };
    part.job = this.decoder.draw({ x, y, ...size, columns, rows }, PRIORITY);
    view.parts.push(part);
    part.job.promise.then(
      (bitmap) => this.arrived(view, part, bitmap),
      (error) => {
        part.failed = true;
        this.lost(error);
      },
    );
  }

  arrived(view, part, bitmap) {
    if (!this.views.includes(view)) return bitmap.close();
    part.bitmap = bitmap;
    if (view === this.views.at(-1) && this.isDone) this.views.splice(0, this.views.length - 1).forEach(close);
    this.changed();
  }

  /** Draws what there is where the camera shows it now; at another scale it is of no use any more. */
  draw(context, camera) {
    if (this.views.length && this.views[0].camera.scale !== camera.scale) this.forget();
    for (const view of this.views) {
      const [right, down] = camera.toScreen(...view.camera.toPicture(0, 0)).map(Math.round);
      for (const { bitmap, column, row } of view.parts) {
        if (!bitmap) continue;
        context.clearRect(column + right, row + down, bitmap.width, bitmap.height); // what is transparent hides tiles
        context.drawImage(bitmap, column + right, row + down);
      }
    }
  }

  forget() {
    for (const view of this.views.splice(0)) close(view);
  }
}

function close({ parts }) {
  for (const { bitmap, job } of parts) {
    bitmap?.close();
    job.cancel();
  }
}
