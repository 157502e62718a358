/** Refuses to pack the package without the decoder, which `make viewer` compiles. */

import { existsSync } from "node:fs";

const missing = ["src/wasm/sgi.wasm", "src/wasm/sgi-scalar.wasm"].filter((path) => !existsSync(new URL(path, import.meta.url)));
if (missing.length) {
  console.error(`sgi-viewer cannot be packed: ${missing.join(" and ")} missing. Run \`make viewer\` first.`);
  process.exit(1);
}
