/** <sgi-image src alt sizes>: a picture in a page, decoded at the size it is shown at, once it is nearly in view. */

import { openDecoder } from "./decoder.js";
import { sentence } from "./errors.js";
import { wholeView } from "./whole.js";

const NEAR = "300px"; // beyond the view
const STYLE = `
  :host { display: inline-block; max-width: 100%; vertical-align: bottom; }
  :host([hidden]), [hidden] { display: none; }
  canvas { display: block; width: 100%; height: 100%; }`;

let watcher;

/** Calls near(isNear) of an element when it comes near the view, and when it leaves. One observer serves all. */
function watch(element) {
  const tell = (entries) => entries.forEach(({ target, isIntersecting }) => target.near(isIntersecting));
  watcher ??= new IntersectionObserver(tell, { rootMargin: NEAR });
  watcher.observe(element);
}

/** The style of an element, which a page's own overrides. sizes: as of <img>; without, the picture's width. */
function layout({ width, height }, sizes) {
  const rules = (sizes || `${width}px`).split(",").reverse().map((one) => {
    const [, media, length] = /^(\(.*?\)(?:\s+and\s+\(.*?\))*)?\s*(.*)$/.exec(one.trim());
    const rule = `:host { width: ${length}; }`;
    return media ? `@media ${media} { ${rule} }` : rule;
  });
  return `${STYLE} :host { aspect-ratio: ${width} / ${height}; } ${rules.join(" ")}`;
}

/** Events: "load", and "error" (detail: a sentence). Where there is no picture, its content shows, or its alt. */
export class SgiImage extends (globalThis.HTMLElement ?? Object) {
  static observedAttributes = ["src", "alt", "sizes"];

  constructor() {
    super();
    const root = this.attachShadow({ mode: "open" });
    root.innerHTML = "<style></style><canvas></canvas><slot hidden></slot>";
    [this.rules, this.canvas, this.instead] = root.children;
    this.rules.textContent = STYLE;
    this.shown = null; // the src that is shown
    this.columns = 0; // that it has
    this.isNear = this.isLoading = false;
    this.resized = new ResizeObserver(() => this.load());
  }

  connectedCallback() {
    if (!this.hasAttribute("role")) this.setAttribute("role", "img");
    watch(this);
    this.resized.observe(this);
  }

  disconnectedCallback() {
    watcher.unobserve(this);
    this.resized.disconnect();
    this.isNear = false;
  }

  attributeChangedCallback(name, before, value) {
    if (name === "alt") {
      this.setAttribute("aria-label", value ?? "");
      this.instead.textContent = value ?? "";
    }
    if (name === "sizes" && this.info) this.rules.textContent = layout(this.info, value);
    this.load();
  }

  near(isNear) {
    this.isNear = isNear;
    this.load();
  }

  get src() {
    return this.getAttribute("src") ?? "";
  }

  set src(value) {
    this.setAttribute("src", value);
  }

  /** The pixels of the screen across it. */
  get pixels() {
    return Math.max(1, Math.round(this.clientWidth * (globalThis.devicePixelRatio || 1)));
  }

  /** Shows the picture, unless it is shown with as many pixels as the screen has for it. */
  async load() {
    if (this.isLoading) return;
    this.isLoading = true;
    const isWanted = () => this.isNear && this.src && (this.shown !== this.src || this.columns < this.pixels);
    while (isWanted()) await this.show(this.src);
    this.isLoading = false;
  }

  async show(src) {
    let decoder;
    let event = new Event("load");
    try {
      decoder = await openDecoder(new URL(src, this.baseURI).href);
      this.info = decoder.info;
      this.rules.textContent = layout(this.info, this.getAttribute("sizes"));
      this.canvas.hidden = false;
      const columns = this.pixels;
      const bitmap = await decoder.draw(wholeView(this.info, columns), 0).promise;
      Object.assign(this.canvas, { width: bitmap.width, height: bitmap.height });
      this.canvas.getContext("bitmaprenderer").transferFromImageBitmap(bitmap);
      this.columns = columns;
    } catch (error) {
      event = new CustomEvent("error", { detail: sentence(error) });
      this.canvas.hidden = true;
      this.columns = Infinity; // not again
    }
    decoder?.close();
    this.instead.hidden = !this.canvas.hidden;
    this.shown = src;
    this.dispatchEvent(event);
  }
}

globalThis.customElements?.define("sgi-image", SgiImage);
