/** `sgi decode` of this clone, whose pixels the tests compare with. */

import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { readPng } from "./png.js";

export const ROOT = fileURLToPath(new URL("../../", import.meta.url));
export const GOLDEN = join(ROOT, "tests/conformance/golden/");
export const PYTHON = process.env.SGI_PYTHON ?? join(ROOT, ".venv/bin/python");

const known = new Map();

/** What the command draws: {width, height, channels, pixels} of 8 bits. */
export function decoded(stream, ...options) {
  const key = [stream, ...options].join(" ");
  if (!known.has(key)) known.set(key, drawn(stream, ...options));
  return known.get(key);
}

function drawn(stream, ...options) {
  const folder = mkdtempSync(join(tmpdir(), "sgi-viewer-"));
  try {
    const target = join(folder, "decoded.png");
    execFileSync(PYTHON, ["-m", "sgicodec", "decode", stream, target, "--depth", "8", "--quiet", ...options.map(String)]);
    return readPng(readFileSync(target));
  } finally {
    rmSync(folder, { recursive: true });
  }
}
