/** The workers of a page, which all its files share. Jobs wait here, so that those which nobody needs are dropped. */

import { SgiError, sentence } from "./errors.js";

const IDLE = 10_000; // milliseconds without a file before workers end, and give their memory back

let shared;

/** Opens a file in the page's workers. opening: {module, place} of a stream, {place: blob} of another picture. */
export function openFile(opening) {
  shared ??= new WorkerPool(Math.max(1, Math.min(4, (globalThis.navigator?.hardwareConcurrency ?? 2) - 1)));
  return new PooledFile(shared, opening);
}

/** A file, as workers have it. */
class PooledFile {
  static count = 0;

  constructor(pool, opening) {
    Object.assign(this, { pool, opening });
    this.number = PooledFile.count++;
    this.fetched = 0;
    this.isClosed = false;
    pool.files.add(this);
  }

  /**
   * {promise, cancel}: what a worker answers to a task ("info", "draw", "model", "ellipses"). Those with the lowest
   * priority come first, those of one lane to the same worker; null: any will do.
   */
  run(task, view, priority, lane = null) {
    const job = { file: this, task, view, priority, lane };
    const promise = new Promise((resolve, reject) => Object.assign(job, { resolve, reject }));
    this.pool.queue.push(job);
    this.pool.next();
    return { promise, cancel: () => this.pool.drop((other) => other === job) };
  }

  close() {
    this.isClosed = true;
    this.pool.close(this);
  }
}

class WorkerPool {
  constructor(most) {
    this.most = most;
    this.files = new Set();
    this.queue = [];
    this.workers = [];
  }

  add() {
    const entry = { worker: null, job: null, opened: new Set() };
    this.workers.push(entry);
    this.start(entry);
  }

  /** Gives an entry a new worker, which has opened nothing. */
  start(entry) {
    entry.worker?.terminate();
    entry.opened.clear();
    entry.worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
    entry.worker.onmessage = ({ data }) => this.done(entry, data);
    entry.worker.onerror = (event) => {
      event.preventDefault?.();
      const error = "The decoder ended without a word; there may be too little memory.";
      this.done(entry, { error, isBroken: true, fetched: 0 });
    };
  }

  drop(isDropped) {
    for (const job of this.queue.filter(isDropped)) job.reject(dropped());
    this.queue = this.queue.filter((job) => !isDropped(job));
  }

  next() {
    if (this.queue.length > (this.workers.length ? 1 : 0) && this.workers.length < this.most) this.add();
    for (const [number, entry] of this.workers.entries()) {
      if (entry.job) continue;
      let best = -1;
      for (const [at, { lane, priority }] of this.queue.entries()) {
        const mine = lane === null || lane % this.workers.length === number;
        if (mine && (best < 0 || priority < this.queue[best].priority)) best = at;
      }
      if (best >= 0) this.send(entry, this.queue.splice(best, 1)[0]);
    }
  }

  send(entry, job) {
    entry.job = job;
    const { file, task, view } = job;
    const opening = entry.opened.has(file) ? null : file.opening;
    entry.worker.postMessage({ file: file.number, opening, task, view });
  }

  done(entry, { answer, error, isBroken, isOpen, fetched }) {
    const { job } = entry;
    entry.job = null;
    if (isBroken) this.start(entry);
    if (job) {
      if (isOpen) entry.opened.add(job.file);
      job.file.fetched += fetched;
      if (job.file.isClosed) {
        this.forget(entry, job.file);
        (answer?.bitmap ?? answer)?.close?.();
        job.reject(dropped());
      } else if (error === undefined) job.resolve(answer);
      else job.reject(new SgiError(sentence(error)));
    }
    this.next();
  }

  close(file) {
    this.files.delete(file);
    this.drop((job) => job.file === file);
    for (const entry of this.workers) if (entry.job?.file !== file) this.forget(entry, file);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.rest(), IDLE);
  }

  forget(entry, file) {
    if (entry.opened.delete(file)) entry.worker.postMessage({ file: file.number, task: "close" });
  }

  /** Ends the workers while no file is open. */
  rest() {
    if (this.files.size || this.workers.some(({ job }) => job)) return;
    for (const { worker } of this.workers.splice(0)) worker.terminate();
  }
}

function dropped() {
  return new DOMException("not needed any more", "AbortError");
}
