/** Draws layers by WebGL2: sums of floats for all tiles that are seen, then what is shown of them. */

import { Device } from "./device.js";
import { TexturePass } from "./texture_pass.js";
import { Tile } from "./tile.js";

const PIXEL_VARIANCE = 0.1; // kPixelVariance: of what a pixel larger than the picture's covers beyond one
const REACH = 3.5; // deviations of it that count
const SAMPLES = 4; // of a base layer's cell along each axis

export class Renderer {
  /** slow: a GPU that is emulated will do. Throws an Error with a sentence. */
  constructor(canvas, slow) {
    this.canvas = canvas;
    this.device = new Device(canvas, slow);
    this.texture = new TexturePass(this.device);
    this.sums = null;
  }

  get isReady() {
    return this.device.isReady;
  }

  get isLost() {
    return this.device.gl.isContextLost();
  }

  upload(numbers) {
    return new Tile(this.device, numbers);
  }

  /** Empties the canvas; it gets the size that is asked for. */
  begin(columns, rows) {
    const { canvas, device } = this;
    if (canvas.width !== columns || canvas.height !== rows) Object.assign(canvas, { width: columns, height: rows });
    if (this.sums?.columns !== columns || this.sums?.rows !== rows) {
      if (this.sums) device.free(this.sums);
      this.sums = device.target(columns, rows);
    }
    device.gl.disable(device.gl.SCISSOR_TEST);
    device.drawTo(null, false);
    device.gl.clearColor(0, 0, 0, 0);
    device.gl.clear(device.gl.COLOR_BUFFER_BIT);
  }

  /** Draws tiles in columns `first` to before `stop` of the screen. shown: [{tile, fades}]; camera: of their picture. */
  draw(shown, camera, first, stop) {
    const { device, sums } = this;
    const { gl } = device;
    const part = seenPart(camera, first, stop);
    const [columns, rows] = [part.right - part.left, part.bottom - part.top];
    if (columns <= 0 || rows <= 0) return;
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(part.left, part.top, columns, rows);
    device.drawTo(sums, true);
    gl.clear(gl.COLOR_BUFFER_BIT);
    for (const { tile, fades } of shown) this.add(tile, fades, camera, part);
    gl.scissor(part.left, sums.rows - part.bottom, columns, rows);
    device.drawTo(null, false);
    device.use("show", { size: [sums.columns, sums.rows], sums: { unit: 0, texture: sums.texture } });
    device.squares(device.corners ??= device.attributes(null, []), 1);
  }

  add(tile, fades, camera, part) {
    const { device, sums } = this;
    const [left, top] = camera.toPicture(0, 0);
    const { scale } = camera;
    const shrunk = Math.max(0, 1 - scale * scale);
    const deviation = Math.sqrt(PIXEL_VARIANCE * shrunk) / scale;
    const step = deviation > 0 ? Math.min(1, deviation) : 1;
    const uniforms = {
      size: [sums.columns, sums.rows],
      start: [left - tile.x, top - tile.y],
      scale,
      extent: [tile.width, tile.height],
      fades,
      wider: PIXEL_VARIANCE * shrunk,
      blur: [deviation, step, Math.ceil((REACH * deviation) / step)],
    };
    const hasBase = tile.base[0] > 0;
    const samples = hasBase ? Math.max(1, Math.ceil(SAMPLES / (scale * tile.side))) : 0;
    const cells = { unit: 0, texture: tile.baseList };
    device.use("base", { ...uniforms, cells, grid: { integers: tile.base }, side: tile.side, samples: { integers: [samples] } });
    device.squares(device.corners ??= device.attributes(null, []), 1);
    this.texture.draw(tile, sums, part, uniforms);
    device.use("gaussian", uniforms);
    device.squares(tile.gaussianArray, tile.gaussians);
  }
}

/** Which part of the screen, of some columns, has pixels with their centres in the picture. */
function seenPart(camera, first, stop) {
  const [left, top] = camera.toScreen(0, 0);
  const [right, bottom] = camera.toScreen(camera.width, camera.height);
  const reached = (place) => Math.ceil(place - 0.5 - 1e-9);
  return {
    left: Math.max(first, reached(left)),
    top: Math.max(0, reached(top)),
    right: Math.min(stop, camera.columns, reached(right)),
    bottom: Math.min(camera.rows, reached(bottom)),
  };
}
