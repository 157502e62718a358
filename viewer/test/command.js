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

/** The first three bands of what the command draws of a picture in bands, which PNG cannot hold. */
export function decodedBands(stream, ...options) {
  const script = "import sys, sgicodec; bands = sgicodec.read(sys.argv[1]).pixels[..., :3]; print(*bands.shape, bands.tobytes().hex())";
  return within((folder) => {
    const target = join(folder, "decoded.tif");
    decode(stream, target, options);
    const [height, width, channels, pixels] = execFileSync(PYTHON, ["-c", script, target]).toString().trim().split(" ");
    return { width: Number(width), height: Number(height), channels: Number(channels), pixels: Buffer.from(pixels, "hex") };
  });
}

/** Of streams, those whose residual layer corrects every view, not only that of their own scale. */
export function exactViews(streams) {
  const lines = execFileSync(PYTHON, ["-m", "sgicodec", "info", "--json", ...streams]).toString().split("\n");
  return new Set(streams.filter((_, at) => JSON.parse(lines[at]).exact_views));
}

function drawn(stream, ...options) {
  return within((folder) => {
    const target = join(folder, "decoded.png");
    decode(stream, target, options);
    return readPng(readFileSync(target));
  });
}

/** Writes what the command draws to a file. */
export function decode(stream, target, options = []) {
  execFileSync(PYTHON, ["-m", "sgicodec", "decode", stream, target, "--depth", "8", "--quiet", ...options.map(String)]);
}

function within(work) {
  const folder = mkdtempSync(join(tmpdir(), "sgi-viewer-"));
  try {
    return work(folder);
  } finally {
    rmSync(folder, { recursive: true });
  }
}
