/** A WebGL2 context with what the renderer needs of it: programs, buffers of floats, lists of numbers. */

import { SHADERS } from "./shaders.js";

const NEEDED = ["EXT_color_buffer_float", "EXT_float_blend"];
const EMULATED = /swiftshader|llvmpipe|software|basic render/i; // names of GPUs that are none
const LIST_COLUMNS = 1024; // as of `listed` in shaders.js

/** Why a canvas cannot be drawn to is an error with a sentence. slow: a GPU that is emulated will do. */
export class Device {
  constructor(canvas, slow) {
    // preserveDrawingBuffer: the last frame can be read after it was shown.
    const shown = { alpha: true, antialias: false, depth: false, preserveDrawingBuffer: true };
    const options = { ...shown, failIfMajorPerformanceCaveat: !slow };
    this.gl = canvas.getContext("webgl2", options);
    if (!this.gl) throw new Error(slow ? "This browser has no WebGL2." : "This browser has no WebGL2 with a GPU.");
    if (!slow && EMULATED.test(this.name)) throw new Error(`This browser has no WebGL2 with a GPU, but ${this.name}.`);
    for (const name of NEEDED) {
      if (!this.gl.getExtension(name)) throw new Error(`The GPU cannot add floats (${name}).`);
    }
    this.parallel = this.gl.getExtension("KHR_parallel_shader_compile");
    this.programs = new Map(Object.entries(SHADERS).map(([name, texts]) => [name, this.begun(texts)]));
    this.quad = this.buffer(new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]));
    this.fences = [];
  }

  get name() {
    const { gl } = this;
    return gl.getParameter(gl.getExtension("WEBGL_debug_renderer_info")?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER);
  }

  /** A program that the browser compiles meanwhile. */
  begun(texts) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [at, text] of texts.entries()) {
      const shader = gl.createShader(at ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    return { program, places: null };
  }

  /** Whether programs are compiled; asking does not wait where the browser can tell. */
  get isReady() {
    const { gl, parallel } = this;
    if (this.compiled) return true;
    const done = ({ program }) => gl.getProgramParameter(program, parallel.COMPLETION_STATUS_KHR);
    if (parallel && ![...this.programs.values()].every(done)) return false;
    // Now, since every question waits until the GPU has done all that it was told before.
    for (const [name, entry] of this.programs) entry.places = this.placesOf(name, entry.program);
    this.compiled = true;
    return true;
  }

  /** Chooses a program and sets its uniforms: numbers, arrays of 2 to 4, {unit, texture}, {integers}. */
  use(name, uniforms) {
    const { gl } = this;
    const { program, places } = this.programs.get(name);
    gl.useProgram(program);
    for (const [key, value] of Object.entries(uniforms)) {
      const place = places.get(key);
      if (place === undefined) continue; // one that this program does not need
      if (value.texture !== undefined) {
        gl.activeTexture(gl.TEXTURE0 + value.unit);
        gl.bindTexture(gl.TEXTURE_2D, value.texture);
        gl.uniform1i(place, value.unit);
      } else if (value.integers) {
        gl[`uniform${value.integers.length}iv`](place, value.integers);
      } else if (Array.isArray(value)) {
        gl[`uniform${value.length}fv`](place, value);
      } else {
        gl.uniform1f(place, value);
      }
    }
  }

  placesOf(name, program) {
    const { gl } = this;
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      const logs = gl.getAttachedShaders(program).map((shader) => gl.getShaderInfoLog(shader));
      throw new Error(`The GPU's driver does not compile "${name}": ${[gl.getProgramInfoLog(program), ...logs].join(" ").trim()}`);
    }
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) ?? 0;
    const names = Array.from({ length: count }, (_, at) => gl.getActiveUniform(program, at).name);
    return new Map(names.map((key) => [key, gl.getUniformLocation(program, key)]));
  }

  buffer(numbers) {
    const { gl } = this;
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    return buffer;
  }

  /** Corners of a square as attribute 0, and behind it those of each instance: numbers of `sizes` at a time. */
  attributes(buffer, sizes) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    this.attribute(this.quad, 0, 2, 8, 0, 0);
    const stride = 4 * sizes.reduce((sum, size) => sum + size, 0);
    let offset = 0;
    for (const [at, size] of sizes.entries()) {
      this.attribute(buffer, at + 1, size, stride, offset, 1);
      offset += 4 * size;
    }
    return array;
  }

  attribute(buffer, at, size, stride, offset, divisor) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(at, divisor);
  }

  /** Draws squares of one program: `count` of them with an array of `attributes`. */
  squares(array, count) {
    const { gl } = this;
    gl.bindVertexArray(array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
  }

  /** A texture of four numbers each that shaders look up by their place in the list. */
  list(numbers) {
    const rows = Math.max(1, Math.ceil(numbers.length / (4 * LIST_COLUMNS)));
    const padded = new Float32Array(4 * LIST_COLUMNS * rows);
    padded.set(numbers);
    return this.texture(LIST_COLUMNS, rows, padded);
  }

  texture(columns, rows, numbers = null) {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, columns, rows, 0, gl.RGBA, gl.FLOAT, numbers);
    return texture;
  }

  /** A buffer of floats that can be drawn to. */
  target(columns, rows) {
    const { gl } = this;
    const texture = this.texture(columns, rows);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    const isWhole = gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE;
    if (!isWhole && !gl.isContextLost()) throw new Error("The GPU has no buffer of floats of this size.");
    return { texture, frame, columns, rows };
  }

  /** Draws to a target, or with null to the canvas; adding to what is there, or instead of it. */
  drawTo(target, adding) {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, target?.frame ?? null);
    gl.viewport(0, 0, target?.columns ?? gl.drawingBufferWidth, target?.rows ?? gl.drawingBufferHeight);
    if (adding) gl.enable(gl.BLEND);
    else gl.disable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
  }

  free({ texture, frame, buffer, array }) {
    const { gl } = this;
    if (texture) gl.deleteTexture(texture);
    if (frame) gl.deleteFramebuffer(frame);
    if (buffer) gl.deleteBuffer(buffer);
    if (array) gl.deleteVertexArray(array);
  }
}
