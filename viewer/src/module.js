/** libsgi as WebAssembly: the build that the browser takes. */

const SIMD = new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
]); // a function that uses a vector of 128 bits

let module_;

/** The compiled module, or null where there is none: then a server has to draw. */
export function loadModule() {
  module_ ??= compiled().catch(() => null);
  return module_;
}

export async function hasModule() {
  return (await loadModule()) !== null;
}

/** Where the build lies. Bundlers find it by these literals. */
export function buildUrl() {
  if (WebAssembly.validate(SIMD)) return new URL("./wasm/sgi.wasm", import.meta.url);
  return new URL("./wasm/sgi-scalar.wasm", import.meta.url);
}

async function compiled() {
  const answer = await fetch(buildUrl());
  if (!answer.ok) return null;
  return WebAssembly.compile(await answer.arrayBuffer());
}
