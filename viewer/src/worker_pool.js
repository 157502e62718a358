/** Workers that decode one file. Jobs wait here, so that those which nobody needs any more are dropped. */

import { SgiError, sentence } from "./errors.js";

/** Calls of `run` are done by priority, the lowest number first; those of one lane by the same worker. */
export class WorkerPool {
  /** opening: {module, place}, what each worker needs to begin; make(): a new worker. */
  constructor(count, opening, make) {
    this.fetched = 0;
    this.queue = [];
    this.running = new Map();
    this.opening = opening;
    this.make = make;
    this.workers = [];
    this.most = count;
    this.add();
  }

  /** The first worker's answer to the opening; the others begin when there is more to do. */
  get opened() {
    return this.workers[0].opened;
  }

  add() {
    const worker = this.make();
    const entry = { worker, job: null, fetched: 0 };
    worker.onmessage = ({ data }) => this.done(entry, data);
    worker.onerror = (event) => {
      event.preventDefault?.();
      this.done(entry, { error: "The decoder ended without a word; there may be too little memory.", fetched: entry.fetched });
    };
    this.workers.push(entry);
    entry.opened = new Promise((resolve, reject) => {
      this.start(entry, { task: "open", ...this.opening, resolve, reject });
    });
    entry.opened.catch(() => {});
  }

  /** {promise, cancel}: what a worker answers to a task. lane: a number, or null where any worker will do. */
  run(task, view, priority, lane = null) {
    const job = { task, view, priority, lane };
    const promise = new Promise((resolve, reject) => Object.assign(job, { resolve, reject }));
    this.queue.push(job);
    this.next();
    return { promise, cancel: () => this.cancel(job) };
  }

  cancel(job) {
    const at = this.queue.indexOf(job);
    if (at < 0) return;
    this.queue.splice(at, 1);
    job.reject(new DOMException("not needed any more", "AbortError"));
  }

  next() {
    if (this.queue.length > 1 && this.workers.length < this.most) this.add();
    for (const [number, entry] of this.workers.entries()) {
      if (entry.job) continue;
      let best = -1;
      for (const [at, { lane, priority }] of this.queue.entries()) {
        const mine = lane === null || lane % this.workers.length === number;
        if (mine && (best < 0 || priority < this.queue[best].priority)) best = at;
      }
      if (best >= 0) this.start(entry, this.queue.splice(best, 1)[0]);
    }
  }

  start(entry, job) {
    entry.job = job;
    const { task, module, place, view } = job;
    entry.worker.postMessage({ task, module, place, view });
  }

  done(entry, { answer, error, fetched }) {
    const job = entry.job;
    entry.job = null;
    this.fetched += fetched - entry.fetched;
    entry.fetched = fetched;
    if (error === undefined) job?.resolve(answer);
    else job?.reject(new SgiError(sentence(error)));
    this.next();
  }

  close() {
    for (const { worker } of this.workers) worker.terminate();
    for (const job of this.queue.splice(0)) job.reject(new DOMException("closed", "AbortError"));
  }
}
