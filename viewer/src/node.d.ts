export { SgiError } from "./index.js";

/** Decodes a stream, of a path, a URL or bytes, in this thread: red, green, blue, alpha of each pixel. */
export function decode(
  source: string | URL | Uint8Array,
  options?: { width?: number },
): Promise<{ width: number; height: number; data: Uint8ClampedArray }>;
