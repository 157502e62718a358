#!/usr/bin/env bash
# Makes Debian packages of libsgi, its programs and the module of gdk-pixbuf, and tries them where nothing else of this
# project is: packaging/debian.sh FOLDER
set -euo pipefail
folder=$(realpath "$1")
root=$(realpath "$(dirname "$0")/..")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mkdir "$work/sgicodec"
git -C "$root" archive HEAD | tar x -C "$work/sgicodec"
cp -r "$root/packaging/debian" "$work/sgicodec/debian"
(cd "$work/sgicodec" && DEB_BUILD_OPTIONS=noautodbgsym dpkg-buildpackage -b -us -uc)
if command -v lintian >/dev/null; then # the maintainers have no public address yet
  lintian --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog --fail-on error "$work"/*.changes
fi

# Installed in a root of their own, which lacks what they depend on.
mkdir -p "$work"/root/var/lib/dpkg/{info,updates,triggers}
touch "$work/root/var/lib/dpkg/status"
dpkg --root="$work/root" --force-depends,not-root,script-chrootless --no-triggers -i "$work"/*.deb
query=$(pkg-config --variable=gdk_pixbuf_query_loaders gdk-pixbuf-2.0)
libraries=$(dirname "$(find "$work/root" -name 'libsgi.so.*' -type l)")
export LD_LIBRARY_PATH=$libraries PKG_CONFIG_PATH=$libraries/pkgconfig PKG_CONFIG_SYSROOT_DIR=$work/root
golden=$root/tests/conformance/golden
"$work/root/usr/bin/sgidec" "$golden/rgb8.sgi" "$work/one.ppm"
"$work/root/usr/bin/sgi-info" --verify "$golden/rgb8.sgi"
# shellcheck disable=SC2046
cc "$root/examples/decode.c" -o "$work/decode" $(pkg-config --cflags --libs sgi)
"$work/decode" "$golden/rgb8.sgi" "$work/two.ppm"
cmp "$work/one.ppm" "$work/two.ppm"
"$query" "$(find "$work/root" -name pixbufloader-sgicodec.so)" | grep image/x-sgicodec
mv "$work"/*.deb "$folder"
