#!/usr/bin/env bash
# Packs the npm package of the viewer, and tries it in a folder of its own: packaging/npm.sh FOLDER
# `make viewer` compiles the decoder that it needs, with Emscripten.
set -euo pipefail
folder=$(realpath "$1")
root=$(realpath "$(dirname "$0")/..")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

(cd "$root/viewer" && npm pack --silent --pack-destination "$work")
cd "$work"
npm init --yes --silent >/dev/null
npm install --silent --no-audit --no-fund ./*.tgz
cat >try.mjs <<'END'
import { readFile } from "node:fs/promises";
import { decode } from "sgi-viewer/node";
const { width, height, data } = await decode(await readFile(process.argv[2]));
if (width !== 192 || height !== 128 || data.length !== 4 * width * height) throw new Error(`${width}×${height}`);
console.log(`sgi-viewer decodes ${width}×${height} pixels in Node ${process.version}`);
END
node try.mjs "$root/tests/conformance/golden/rgb8.sgi"
mv ./*.tgz "$folder"
