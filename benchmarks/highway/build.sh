#!/bin/bash
# Builds and runs the trial of Google Highway: build.sh x86|neon|wasm [turns [width height]]; see README.md.
set -eu
target=${1:-x86}
shift $(($# > 0))
: "${HIGHWAY:?set HIGHWAY to the folder of Google Highway that holds hwy/highway.h}"
here=$(cd "$(dirname "$0")" && pwd)
root=$(git -C "$here" rev-parse --show-toplevel)
out=$root/build/highway/$target
rm -rf "$out" && mkdir -p "$out/raster" && cd "$out"
if [ -n "${RASTER:-}" ]; then cp "$RASTER"/*.[ch]pp raster/
else git -C "$root" archive e415d65 sgicodec/raster/cpp | tar -x --strip-components=3 -C raster; fi
flags=(-std=gnu++17 -O3 -ffp-contract=fast -fno-math-errno -fno-trapping-math -Wno-psabi -Iraster)
flags+=("-I$here" "-I$HIGHWAY")
static=-DHWY_COMPILE_ONLY_STATIC

compile() {  # SOURCE FLAGS...: prints the seconds of processor time
  local TIMEFORMAT="$(basename "$1") compiled in %U s"
  time $CXX "${flags[@]}" "${@:2}" -c "$1"
}

case $target in
x86)
  CXX=${CXX:-g++} flags+=(-DSGI_X86) static=
  compile raster/kernel_avx2.cpp -mavx2 -mfma
  compile raster/kernel_avx512.cpp -mavx512{f,dq,vl,bw} -mfma -mprefer-vector-width=512
  flags+=("-DHWY_DISABLED_TARGETS=${DISABLED-(HWY_SSSE3|HWY_SSE4|HWY_AVX3_DL|HWY_AVX3_ZEN4|HWY_AVX3_SPR|HWY_AVX10_2)}")
  $CXX -O2 "-I$HIGHWAY" -c "$HIGHWAY"/hwy/{targets,per_target,abort}.cc ;;
neon) CXX=${CXX:-aarch64-linux-gnu-g++} ;;
wasm)
  CXX=${CXX:-clang++}
  flags+=(--target=wasm32-wasi -msimd128 -fno-exceptions "-Dthrow=(void)" -D_WASI_EMULATED_PROCESS_CLOCKS) ;;
esac
for source in raster/kernel_portable.cpp "$here"/kernel_highway.cpp raster/binning.cpp "$here"/trial.cpp; do
  compile "$source" $static
done
case $target in
x86) $CXX ./*.o -o trial && size kernel_*.o && ./trial "$@" ;;
neon) $CXX -static ./*.o -o trial && "${CXX%g++}size" kernel_*.o && ${RUN-qemu-aarch64} ./trial "$@" ;;
wasm)
  $CXX --target=wasm32-wasi ./*.o -lwasi-emulated-process-clocks -o trial.wasm
  node --no-warnings "$here/run_wasm.mjs" trial.wasm "$@" ;;
esac
