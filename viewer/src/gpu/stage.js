/** The canvas below the scene's own that the GPU draws to: whether it does, and why not. */

import { Renderer } from "./renderer.js";

const POLL = 20; // milliseconds between questions whether programs are compiled
const SLOW = 34; // milliseconds that a frame may wait for the one before: less than 30 frames a second
const FRAMES = 12; // whose waits are looked at

export const MODES = ["auto", "gpu", "cpu"];

export class Stage {
  /** above: the canvas that lies over it; changed(): something else draws from now on. */
  constructor(above, changed) {
    this.changed = changed;
    this.mode = "auto";
    this.reason = ""; // a sentence, where there is no GPU to draw though it might
    this.waits = [];
    this.isSlow = false;
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("aria-hidden", "true");
    above.before(this.canvas);
    this.canvas.addEventListener("webglcontextlost", (event) => this.lost(event));
    this.canvas.addEventListener("webglcontextrestored", () => this.restored());
    this.made = null; // the renderer; null before it is wanted, and where there can be none
    this.tried = ""; // the mode in which there was none
    this.shows = "";
  }

  choose(mode) {
    if (!MODES.includes(mode)) return;
    this.mode = mode;
    this.waits = [];
    this.isSlow = false;
    this.changed();
  }

  /** What draws, once it can; null where the GPU shall not or cannot. */
  get renderer() {
    if (this.mode === "cpu" || (this.mode === "auto" && this.isSlow) || this.isLost) return null;
    this.make();
    if (!this.made) return null;
    try {
      if (this.made.isReady) return this.made;
    } catch (error) {
      this.fail(error);
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

  /** Why there is no renderer, as a sentence. */
  get refusal() {
    if (this.mode === "cpu") return "Workers draw, as chosen.";
    return this.reason || (this.isComing ? "The GPU is getting ready." : "");
  }

  make() {
    if (this.made || this.tried === this.mode) return;
    try {
      this.made = new Renderer(this.canvas, this.mode === "gpu");
      this.reason = "";
    } catch (error) {
      this.fail(error);
    }
  }

  /** Draws no more in this mode. */
  fail(error) {
    this.made = null;
    this.tried = this.mode;
    this.reason = error.message;
  }

  /** Draws plans of layers: [{shown, camera, first, stop}]. key: what the picture depends on. */
  draw(parts, columns, rows, key) {
    if (key === this.shows) return;
    this.made.begin(columns, rows);
    for (const { shown, camera, first, stop } of parts) this.made.draw(shown, camera, first, stop);
    this.shows = key;
  }

  /** A copy of columns `first` to before `stop` of what it shows; null where it shows nothing. */
  copy(first, stop) {
    if (!this.shows || !this.made || stop <= first) return null;
    const copy = new OffscreenCanvas(stop - first, this.canvas.height);
    copy.getContext("2d").drawImage(this.canvas, -first, 0);
    return copy;
  }

  clear() {
    if (!this.shows || !this.made) return;
    this.made.begin(this.canvas.width, this.canvas.height);
    this.shows = "";
  }

  /** Notes how long a frame that the GPU drew had to wait: "auto" gives up one that is slow. */
  waited(milliseconds) {
    this.waits.push(milliseconds);
    if (this.waits.length < FRAMES) return;
    this.waits.sort((a, b) => a - b);
    this.isSlow = this.waits[FRAMES >> 1] > SLOW;
    if (this.isSlow && this.mode === "auto") this.reason = "The GPU took too long for each frame.";
    this.waits = [];
  }

  lost(event) {
    event.preventDefault(); // else it is never restored
    this.isLost = true;
    this.made = null;
    this.shows = "";
    this.reason = "The browser has taken the GPU away.";
    this.changed();
  }

  restored() {
    this.isLost = false;
    this.tried = this.reason = "";
    this.changed();
  }

  close() {
    clearTimeout(this.timer);
    this.changed = () => {};
    this.canvas.remove();
    this.made?.device.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
