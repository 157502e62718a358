/** The line below the picture and the scale bar on it: place, scale, bytes. */

import { megabytes } from "./bytes.js";
import { scaleBar } from "./scale_bar.js";

const BAR = 160; // CSS pixels that the scale bar takes at most

export class StatusLine {
  /** parts: the elements canvas, bar, ellipses, scale, bytes, place. */
  constructor(scene, parts) {
    Object.assign(this, { scene, parts });
    const show = () => scene.decoder && this.show();
    for (const name of ["moved", "drawn"]) scene.addEventListener(name, show);
    parts.canvas.addEventListener("pointermove", (event) => scene.decoder && this.showPlace(event));
  }

  show() {
    const { scene, parts } = this;
    const { scale } = scene.camera;
    parts.ellipses.textContent = scene.ellipses?.total === null ? "Ellipses: zoom in" : "Ellipses";
    parts.scale.textContent = scale >= 1 ? `${round(scale)}×` : `1/${round(1 / scale)}`;
    this.showBar();
    this.showBytes();
  }

  showBar() {
    const { bar, canvas } = this.parts;
    const ratio = canvas.width / canvas.clientWidth;
    const { pixels, text } = scaleBar(this.scene.camera.scale / ratio, BAR, this.scene.decoder.info.pixelMetres);
    bar.hidden = false;
    bar.style.width = `${pixels}px`;
    bar.textContent = text;
  }

  showBytes() {
    const { scene } = this;
    const { bytes } = this.parts;
    if (scene.decoder.info.kind === "server") {
      bytes.textContent = `${megabytes(scene.bytes)}, drawn by the server`;
      bytes.title = "This installation lacks the decoder's WebAssembly, or this browser has none.";
      return;
    }
    const share = (100 * scene.fetched) / scene.bytes;
    const fetched = scene.fetched ? `${megabytes(scene.fetched)} of ` : "";
    bytes.textContent = fetched + megabytes(scene.bytes) + (fetched ? ` (${round(share)} %)` : "");
  }

  /** The pixel under the pointer. */
  showPlace(event) {
    const { canvas, place } = this.parts;
    const box = canvas.getBoundingClientRect();
    const ratio = canvas.width / box.width;
    const { width, height, scale } = this.scene.camera;
    const [x, y] = this.scene.camera.toPicture((event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio);
    const inside = x >= 0 && y >= 0 && x < width && y < height;
    const shown = (value) => (scale > 2 ? value.toFixed(1) : Math.floor(value));
    place.textContent = `${inside ? `${shown(x)}, ${shown(y)} of ` : ""}${width} × ${height}`;
  }
}

function round(value) {
  return value < 10 ? Number(value.toFixed(2)) : Number(value.toFixed(value < 100 ? 1 : 0));
}
