/** What the canvas shows: a picture, perhaps a second one beside it, and the ellipses of Gaussians. */

import { Camera } from "./camera.js";
import { drawDifference } from "./difference.js";
import { Ellipses } from "./ellipses.js";
import { Layer } from "./layer.js";

const STILL = 120; // milliseconds without movement before the view is refined

/** Events: "moved" (the camera did), "drawn" (a frame), "failed" (detail: the error). */
export class Scene extends EventTarget {
  constructor(canvas) {
    super();
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.camera = new Camera();
    this.layers = [];
    this.failed = (error) => this.dispatchEvent(new CustomEvent("failed", { detail: error }));
    this.split = 0.5; // where the second picture begins, of the canvas's width
    this.difference = 0; // of both pictures, by how much it is amplified; 0: they lie side by side
    this.ellipses = null; // while they are shown
    this.frame = this.timer = 0;
    this.watcher = new ResizeObserver((entries) => this.resize(entries.at(-1)));
    try {
      this.watcher.observe(canvas, { box: "device-pixel-content-box" });
    } catch {
      this.watcher.observe(canvas); // Safari: where the device's ratio is no integer, pixels are about right
    }
    this.resize();
  }

  /** Shows a decoder's picture instead of what was shown. */
  open(decoder) {
    this.closeLayers(0);
    this.layers = [this.layerOf(decoder)];
    const { width, height } = decoder.info;
    Object.assign(this.camera, { width, height });
    this.camera.fit();
    this.moved();
  }

  /** Shows a second picture to the right of the split, scaled onto the first one; null: none. */
  compare(decoder) {
    this.closeLayers(1);
    if (decoder) this.layers.push(this.layerOf(decoder));
    this.dirty();
  }

  layerOf(decoder) {
    return new Layer(decoder, () => this.dirty(), this.failed);
  }

  closeLayers(from) {
    for (const layer of this.layers.splice(from)) layer.close();
    this.difference = 0;
    if (!from && this.ellipses) this.showEllipses(true);
  }

  close() {
    this.closeLayers(0);
    this.watcher.disconnect();
    cancelAnimationFrame(this.frame);
    clearTimeout(this.timer);
  }

  get decoder() {
    return this.layers[0]?.decoder ?? null;
  }

  get fetched() {
    return this.layers.reduce((sum, { decoder }) => sum + decoder.fetched, 0);
  }

  get bytes() {
    return this.layers.reduce((sum, { decoder }) => sum + decoder.info.bytes, 0);
  }

  /** Whether the canvas shows the best there is of this view. */
  get isDone() {
    const still = !this.frame && !this.timer;
    return still && this.layers.every((layer) => layer.isDone) && (this.ellipses?.isDone(this.camera) ?? true);
  }

  resize(entry) {
    const ratio = globalThis.devicePixelRatio || 1;
    const { clientWidth, clientHeight } = this.canvas;
    const exact = entry?.devicePixelContentBoxSize?.[0];
    const before = this.camera.fitting;
    const fits = Math.abs(this.camera.scale / before - 1) < 1e-6;
    this.canvas.width = this.camera.columns = Math.max(1, exact?.inlineSize ?? Math.round(clientWidth * ratio));
    this.canvas.height = this.camera.rows = Math.max(1, exact?.blockSize ?? Math.round(clientHeight * ratio));
    if (fits) this.camera.fit();
    this.moved();
  }

  /** Calls change(camera) and draws what it then shows. */
  move(change) {
    change(this.camera);
    this.moved();
  }

  moved() {
    this.dispatchEvent(new Event("moved"));
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.refine(), STILL);
    this.dirty();
  }

  dirty() {
    this.frame ||= requestAnimationFrame(() => this.draw());
  }

  refine() {
    this.timer = 0;
    for (const [number, layer] of this.layers.entries()) layer.refine(this.cameraOf(number));
    if (this.decoder) this.ellipses?.ask(this.decoder, this.camera);
    this.dirty();
  }

  /** The camera in the pixels of a layer: the second picture lies on the first one, whatever its size. */
  cameraOf(number) {
    if (number === 0) return this.camera;
    const { width, height } = this.layers[number].decoder.info;
    const factor = width / this.camera.width;
    const camera = Object.assign(new Camera(), this.camera);
    return Object.assign(camera, { width, height, x: camera.x * factor, y: camera.y * factor, scale: camera.scale / factor });
  }

  /** Which columns of the canvas a layer has: all, or those on its side of the split. */
  columnsOf(number) {
    const { width } = this.canvas;
    const edge = Math.round(this.split * width);
    if (this.layers.length < 2 || this.difference) return [0, width];
    return number ? [edge, width] : [0, edge];
  }

  draw() {
    this.frame = 0;
    const { context, canvas } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.imageSmoothingEnabled = true;
    context.imageSmoothingQuality = "low"; // tiles have at most twice the screen's pixels; more costs frames
    if (this.difference) this.drawBoth();
    else for (const number of this.layers.keys()) this.drawLayer(number);
    this.ellipses?.draw(context, this.camera);
    this.dispatchEvent(new Event("drawn"));
  }

  /** Draws a layer in its columns. */
  drawLayer(number) {
    const { context, canvas } = this;
    const [start, stop] = this.columnsOf(number);
    context.save();
    context.beginPath();
    context.rect(start, 0, stop - start, canvas.height);
    context.clip();
    this.layers[number].draw(context, this.cameraOf(number));
    context.restore();
  }

  /** Draws the difference of both pictures. */
  drawBoth() {
    const { width, height } = this.canvas;
    const second = new OffscreenCanvas(width, height);
    this.layers[0].draw(this.context, this.cameraOf(0));
    this.layers[1].draw(second.getContext("2d"), this.cameraOf(1));
    drawDifference(this.context, second, this.difference);
  }

  /** Shows `factor` times the difference of both pictures (a power of two); 0: shows them side by side. */
  showDifference(factor) {
    this.difference = factor;
    this.moved();
  }

  /** Shows the ellipses of Gaussians, or shows them no more. */
  showEllipses(shown) {
    this.ellipses?.close();
    this.ellipses = shown ? new Ellipses(() => this.dirty(), this.failed) : null;
    this.moved();
  }
}
