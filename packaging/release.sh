#!/usr/bin/env bash
# Makes what a release consists of in dist/, and tries each part in an environment of its own:
#   packaging/release.sh PYTHON...
# A part whose tools are not here is left out, and the list at the end says so. Nothing is uploaded.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
out=$PWD/dist
rm -rf "$out"
mkdir -p "$out/logs"
failed=0 report=""

# part NAME "TOOLS" COMMAND...: runs it where all tools are here.
part() {
  local name=$1 tools=$2 missing="" tool started=$SECONDS
  shift 2
  for tool in $tools; do command -v "$tool" >/dev/null || missing="$missing $tool"; done
  if [ -n "$missing" ]; then
    report+="$name: left out, there is no$missing"$'\n'
  elif "$@" >"$out/logs/$name.log" 2>&1; then
    report+="$name: made and tried, $((SECONDS - started)) s"$'\n'
  else
    report+="$name: FAILED, see dist/logs/$name.log"$'\n'
    failed=1
  fi
}

sdist() {
  local work
  work=$(mktemp -d)
  "$1" -m venv "$work" && "$work/bin/python" -m pip -q install build &&
    "$work/bin/python" -m build --sdist --outdir "$out" . && rm -rf "$work"
}

conda() {
  mkdir "$out/conda" && cp packaging/conda/recipe.yaml "$out/conda"
}

part viewer "emcmake cmake" make viewer
part sdist "$1 c++" sdist "$1"
source=$(echo "$out"/*.tar.gz)
for python in "$@"; do part "wheel-$(basename "$python")" "$python c++" packaging/wheel.sh "$source" "$out" "$python"; done
part wheel-aarch64 "aarch64-linux-gnu-g++ qemu-aarch64 apt-get" packaging/aarch64.sh "$source" "$out" "$1"
part npm "npm node" packaging/npm.sh "$out"
part debian "dpkg-buildpackage dh cmake c++" packaging/debian.sh "$out"
part conda "$1" conda
(cd "$out" && find . -maxdepth 2 -type f ! -path './logs/*' ! -name SHA256SUMS | sort | xargs sha256sum >SHA256SUMS)
cat "$out/SHA256SUMS"
printf '%s' "$report"
exit $failed
