/** A stream that `sgi serve` or `sgi view` draws, by IIIF: for installations without the decoder's WebAssembly. */

import { SgiError } from "./errors.js";

const MOST_AT_A_TIME = 6;

export class IiifDecoder {
  /** The decoder of a URL files/NAME of the page's server; null where no such server answers. */
  static async open(address) {
    const url = new URL(address, location.href);
    const root = new URL("..", location.href).pathname; // of the server, which may lie in a folder of a site
    const name = url.pathname.startsWith(`${root}files/`) ? url.pathname.slice(root.length + "files/".length) : "";
    if (!/.\.sgi$/i.test(name)) return null;
    const base = `${url.origin}${root}iiif/3/${name.replaceAll("/", "%2F")}`;
    const answer = await fetch(`${base}/info.json`).catch(() => null);
    if (!answer) return null;
    if (!answer.ok) throw new SgiError((await answer.text()).trim());
    const { width, height } = await answer.json();
    const head = await fetch(url, { method: "HEAD" });
    const bytes = Number(head.headers.get("content-length"));
    return new IiifDecoder(base, { width, height, bytes, name: decodeURIComponent(name), kind: "server" });
  }

  constructor(base, info) {
    this.base = base;
    this.info = { ...info, tileSize: 0, tiles: 1, hasOverview: false };
    this.fetched = 0;
    this.isContinuous = false;
    this.waiting = [];
    this.running = 0;
  }

  draw({ x, y, width, height, columns, rows }, priority) {
    const left = Math.max(0, Math.round(x));
    const top = Math.max(0, Math.round(y));
    const across = Math.max(1, Math.min(Math.round(width), this.info.width - left));
    const down = Math.max(1, Math.min(Math.round(height), this.info.height - top));
    const larger = columns > across || rows > down ? "^" : "";
    const address = `${this.base}/${left},${top},${across},${down}/${larger}${columns},${rows}/0/default.png`;
    const stop = new AbortController();
    const job = { address, priority, signal: stop.signal };
    const promise = new Promise((resolve, reject) => Object.assign(job, { resolve, reject }));
    this.waiting.push(job);
    this.next();
    return { promise, cancel: () => stop.abort() };
  }

  next() {
    while (this.running < MOST_AT_A_TIME && this.waiting.length) {
      const best = this.waiting.reduce((a, b) => (b.priority < a.priority ? b : a));
      this.waiting.splice(this.waiting.indexOf(best), 1);
      this.running++;
      this.get(best)
        .then(best.resolve, best.reject)
        .finally(() => {
          this.running--;
          this.next();
        });
    }
  }

  async get({ address, signal }) {
    const answer = await fetch(address, { signal });
    if (!answer.ok) throw new SgiError((await answer.text()).trim());
    const blob = await answer.blob();
    this.fetched += blob.size;
    return createImageBitmap(blob);
  }

  async ellipses() {
    return null;
  }

  close() {
    for (const job of this.waiting.splice(0)) job.reject(new DOMException("closed", "AbortError"));
  }
}
