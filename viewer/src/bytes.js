/** Where the bytes of a file come from, found out once on the page; workers read them by `ByteReader`. */

import { SgiError } from "./errors.js";

const HEAD = 1 << 16;
const WHOLE = 1 << 20; // files up to this size are fetched whole: every worker reads them
const MOST_WITHOUT_RANGES = 1 << 29;

/**
 * @typedef {{kind: "bytes", bytes: ArrayBuffer, size: number}
 *   | {kind: "blob", blob: Blob, size: number}
 *   | {kind: "url", url: string, head: ArrayBuffer, size: number}} Place
 */

/** The place of a file: a File, a Blob, or a URL. Small files, and those of servers without ranges, are fetched. */
export async function placeOf(source) {
  if (source instanceof Blob) {
    return { place: { kind: "blob", blob: source, size: source.size }, fetched: 0, name: source.name ?? "" };
  }
  const url = new URL(source, globalThis.location?.href).href;
  const name = decodeURIComponent(new URL(url).pathname.split("/").pop());
  const first = await get(url, `bytes=0-${HEAD - 1}`);
  if (first.status === 206) {
    const head = await body(first);
    const size = await totalOf(first, url);
    if (size > WHOLE) return { place: { kind: "url", url, head, size }, fetched: head.byteLength, name };
    const bytes = size > head.byteLength ? joined(head, await body(await get(url, `bytes=${HEAD}-`))) : head;
    return { place: { kind: "bytes", bytes, size: bytes.byteLength }, fetched: bytes.byteLength, name };
  }
  const length = Number(first.headers.get("content-length"));
  if (length > MOST_WITHOUT_RANGES) {
    first.body?.cancel();
    throw new SgiError(`The server does not send parts of files, and ${megabytes(length)} are too many to fetch whole.`);
  }
  const bytes = await body(first);
  return { place: { kind: "bytes", bytes, size: bytes.byteLength }, fetched: bytes.byteLength, name };
}

async function get(url, range) {
  let answer;
  try {
    answer = await fetch(url, { headers: { Range: range } });
  } catch {
    throw new SgiError(`The file cannot be fetched: its server does not answer, or lets no other site read it (CORS).`);
  }
  if (answer.ok) return answer;
  if (answer.headers.get("content-type")?.startsWith("text/plain") && Number(answer.headers.get("content-length")) < 500) {
    const text = (await answer.text()).trim(); // of sgi serve and sgi view: a sentence
    if (text) throw new SgiError(text);
  }
  answer.body?.cancel();
  if (answer.status === 416) throw new SgiError("The file is empty.");
  if (answer.status === 404) throw new SgiError("The server has no such file.");
  throw new SgiError(`The server refuses to send the file (HTTP ${answer.status}).`);
}

async function body(answer) {
  try {
    return await answer.arrayBuffer();
  } catch {
    throw new SgiError("The connection to the server broke while the file was fetched.");
  }
}

/** The size of the whole file: another site's server may not show the header that says so. */
async function totalOf(answer, url) {
  const total = Number(answer.headers.get("content-range")?.split("/")[1]);
  if (total > 0) return total;
  const head = await fetch(url, { method: "HEAD" }).catch(() => null);
  const length = Number(head?.headers.get("content-length"));
  if (length > 0) return length;
  throw new SgiError("The server does not say how large the file is.");
}

function joined(first, second) {
  const all = new Uint8Array(first.byteLength + second.byteLength);
  all.set(new Uint8Array(first));
  all.set(new Uint8Array(second), first.byteLength);
  return all.buffer;
}

export function megabytes(count) {
  return count < 1e5 ? `${(count / 1e3).toFixed(1)} kB` : `${(count / 1e6).toFixed(count < 1e7 ? 2 : 1)} MB`;
}
