/** A static server of the page and of test files, which can behave like bad ones. */

import { closeSync, openSync, readSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };

/** {address, sent, close()}. folders: of URL prefixes. ranges: whether parts of files are sent. `sent`: bytes by path. */
export async function serve(folders, { ranges = true, headers = {} } = {}) {
  const sent = new Map();
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, "http://x").pathname);
    const prefix = Object.keys(folders).find((start) => path.startsWith(start));
    const file = prefix && join(folders[prefix], normalize(path.slice(prefix.length) || "index.html"));
    let size;
    try {
      size = statSync(file).size;
    } catch {
      return response.writeHead(404).end();
    }
    const asked = ranges && /^bytes=(\d+)-(\d*)$/.exec(request.headers.range ?? "");
    const start = asked ? Number(asked[1]) : 0;
    const stop = asked && asked[2] ? Math.min(Number(asked[2]) + 1, size) : size;
    const body = Buffer.alloc(request.method === "HEAD" ? 0 : stop - start);
    const handle = openSync(file);
    readSync(handle, body, 0, body.length, start);
    closeSync(handle);
    sent.set(path, (sent.get(path) ?? 0) + body.length);
    response.writeHead(asked ? 206 : 200, {
      "content-type": TYPES[extname(file)] ?? "application/octet-stream",
      "content-length": stop - start,
      ...(asked && { "content-range": `bytes ${start}-${stop - 1}/${size}` }),
      ...headers,
    });
    response.end(body);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const close = () => new Promise((resolve) => server.close(resolve));
  return { address: `http://127.0.0.1:${server.address().port}`, sent, close };
}
