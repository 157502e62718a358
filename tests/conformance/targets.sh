#!/usr/bin/env bash
# Runs the conformance suite with the decoder compiled for every target whose tools are here, and prints a line for
# each: tests/conformance/targets.sh [--streams TEXT]
set -uo pipefail
cd "$(dirname "$0")/../.."
given='{stream} {out} {x} {y} {width} {height} {columns} {rows} {type}'
failed=0

# target NAME "TOOLS" "RUNNER" PROGRAM-SUFFIX CMAKE...: builds in build/conformance/NAME, and runs.
target() {
  local name=$1 tools=$2 runner=$3 suffix=$4 configure=cmake folder=build/conformance/$1 tool
  shift 4
  for tool in $tools; do
    command -v "$tool" >/dev/null || { echo "$name: not tried, there is no $tool"; return; }
  done
  [ "${tools%% *}" = emcmake ] && configure="emcmake cmake"
  mkdir -p "$folder"
  { $configure -S . -B "$folder" -DCMAKE_BUILD_TYPE=Release -DSGI_CONFORMANCE=ON "$@" &&
    cmake --build "$folder" --parallel "$(nproc)"; } >"$folder.log" 2>&1 ||
    { echo "$name: does not build, $folder.log says why"; failed=1; return; }
  echo -n "$name: "
  WINEDEBUG=-all python3 tests/conformance/suite.py "$runner $folder/conformance_decode$suffix $given" "${streams[@]}" ||
    failed=1
}

streams=("$@")
system() { echo "-DCMAKE_SYSTEM_NAME=$1 -DCMAKE_SYSTEM_PROCESSOR=$2 -DCMAKE_C_COMPILER=$3-gcc$4 -DCMAKE_CXX_COMPILER=$3-g++$4"; }
target this-processor "cmake c++" "" ""
target without-avx512 "cmake c++" "" "" -DSGI_AVX512=OFF
target aarch64 "aarch64-linux-gnu-g++ qemu-aarch64" "qemu-aarch64 -L /usr/aarch64-linux-gnu" "" \
  $(system Linux aarch64 aarch64-linux-gnu "")
target windows "x86_64-w64-mingw32-g++-posix wine" "wine" .exe \
  $(system Windows x86_64 x86_64-w64-mingw32 -posix) -DCMAKE_EXE_LINKER_FLAGS=-static
wasm="-fwasm-exceptions"
files="-sNODERAWFS=1 -sALLOW_MEMORY_GROWTH=1 -sEXIT_RUNTIME=1"
# -O3 when linking would optimise the JavaScript around it, which Debian's Emscripten cannot.
target webassembly "emcmake node" "node --no-experimental-fetch" .js -DCMAKE_CXX_FLAGS_RELEASE=-DNDEBUG "-DCMAKE_CXX_FLAGS=$wasm" \
  "-DCMAKE_EXE_LINKER_FLAGS=$files"
target webassembly-vectors "emcmake node" "node --no-experimental-fetch" .js -DCMAKE_CXX_FLAGS_RELEASE=-DNDEBUG \
  "-DCMAKE_CXX_FLAGS=$wasm -msimd128" "-DCMAKE_EXE_LINKER_FLAGS=$files"
exit $failed
