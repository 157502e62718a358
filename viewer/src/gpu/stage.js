/** The GPU as a scene has it: whether it draws, and why not. */

import { Renderer } from "./renderer.js";

const POLL = 20; // milliseconds between questions whether programs are compiled
const SLOW = 34; // milliseconds that a frame may wait for the one before: less than 30 frames a second
const FRAMES = 12; // whose waits are looked at

export const MODES = ["auto", "gpu", "cpu"];

let shared;

/** The one WebGL context of a page, of which browsers keep about 16: scenes draw to its canvas and copy what is there. */
class Gpu {
  constructor() {
    this.stages = new Set();
    this.renderer = null; // before it is wanted, and where there can be none
    this.tried = new Set(); // modes in which there was none
    this.reason = ""; // a sentence, why there is none
    this.isLost = false;
    this.shows = ""; // what its canvas shows
    this.canvas = document.createElement("canvas");
    this.canvas.addEventListener("webglcontextlost", (event) => this.lost(event));
    this.canvas.addEventListener("webglcontextrestored", () => this.restored());
  }

  /** Makes the renderer, where there is none and this mode was not tried. */
  make(mode) {
    if (this.renderer || this.tried.has(mode)) return;
    try {
      this.renderer = new Renderer(this.canvas, mode === "gpu");
      this.reason = "";
    } catch (error) {
      this.fail(error, mode);
    }
  }

  /** Draws no more in this mode. */
  fail(error, mode) {
    this.tried.add(mode);
    this.end(error.message);
  }

  lost(event) {
    event.preventDefault(); // else it is never restored
    this.isLost = true;
    this.end("The browser has taken the GPU away.");
  }

  restored() {
    this.isLost = false;
    this.tried.clear();
    this.reason = "";
    this.changed();
  }

  end(reason) {
    this.renderer = null;
    this.shows = "";
    this.reason = reason;
    this.changed();
  }

  changed() {
    for (const stage of this.stages) stage.changed();
  }
}

export class Stage {
  /** changed(): something else draws from now on. */
  constructor(changed) {
    this.changed = changed;
    this.mode = "auto";
    this.waits = [];
    this.isSlow = false;
    this.shows = ""; // what the scene drew last, by the GPU
    this.gpu = shared ??= new Gpu();
    this.gpu.stages.add(this);
  }

  choose(mode) {
    if (!MODES.includes(mode)) return;
    this.mode = mode;
    this.gpu.tried.delete(mode);
    this.waits = [];
    this.isSlow = false;
    this.changed();
  }

  /** What draws, once it can; null where the GPU shall not or cannot. */
  get renderer() {
    const { gpu, mode } = this;
    if (mode === "cpu" || (mode === "auto" && this.isSlow) || gpu.isLost) return null;
    gpu.make(mode);
    try {
      if (!gpu.renderer || gpu.renderer.isReady) return gpu.renderer;
    } catch (error) {
      gpu.fail(error, mode);
      return null;
    }
    this.timer ||= setTimeout(() => {
      this.timer = 0;
      this.changed();
    }, POLL);
    return null;
  }

  /** Whether a renderer is on its way. */
  get isComing() {
    return Boolean(this.timer);
  }

  /** Where there is no GPU to draw though it might, a sentence. */
  get reason() {
    return this.mode === "auto" && this.isSlow ? "The GPU took too long for each frame." : this.gpu.reason;
  }

  /** Why there is no renderer, as a sentence. */
  get refusal() {
    if (this.mode === "cpu") return "Workers draw, as chosen.";
    return this.reason || (this.isComing ? "The GPU is getting ready." : "");
  }

  fail(error) {
    this.gpu.fail(error, this.mode);
  }

  /** Has the canvas show plans of layers, [{shown, camera, first, stop}]. key: what the picture depends on. */
  draw(parts, columns, rows, key) {
    const { gpu } = this;
    this.shows = key;
    if (key === gpu.shows) return;
    gpu.renderer.begin(columns, rows);
    for (const { shown, camera, first, stop } of parts) gpu.renderer.draw(shown, camera, first, stop);
    gpu.shows = key;
  }

  get canvas() {
    return this.gpu.canvas;
  }

  /** A copy of columns `first` to before `stop` of what the scene drew; null where the canvas shows it no more. */
  copy(first, stop) {
    if (!this.shows || this.shows !== this.gpu.shows || stop <= first) return null;
    const copy = new OffscreenCanvas(stop - first, this.canvas.height);
    copy.getContext("2d").drawImage(this.canvas, -first, 0);
    return copy;
  }

  /** Notes how long a frame that the GPU drew had to wait: "auto" gives up one that is slow. */
  waited(milliseconds) {
    this.waits.push(milliseconds);
    if (this.waits.length < FRAMES) return;
    this.waits.sort((a, b) => a - b);
    this.isSlow = this.waits[FRAMES >> 1] > SLOW;
    this.waits = [];
  }

  close() {
    clearTimeout(this.timer);
    this.gpu.stages.delete(this);
  }
}
