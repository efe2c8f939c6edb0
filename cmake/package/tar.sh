#!/bin/sh
# Packs the program with its libraries, manual page, docs and datasets into an archive that runs from any folder:
#   tar.sh BUILD DIST    writes DIST/poise-VERSION-linux-ARCH.tar.gz from a finished build folder
set -eu

build=$(realpath "$1")
mkdir -p "$2"
dist=$(realpath "$2")
here=$(dirname "$(realpath "$0")")
version=$(sed -n 's/^CMAKE_PROJECT_VERSION:.*=//p' "$build/CMakeCache.txt")
name=poise-$version-linux-$(uname -m)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/$name" --component program >"$work/log" || { cat "$work/log" >&2; exit 1; }
/usr/bin/python3 "$here/bundle_libraries.py" --into "$work/$name/lib" --licences "$work/$name/share/poise/licences" \
  "$work/$name/bin/poise"
/usr/bin/python3 -B "$here/drop_dead_links.py" "$work/$name/share/poise"
chmod -R u+rwX,go+rX,go-w "$work/$name"
tar --create --owner=0 --group=0 --numeric-owner --sort=name --directory "$work" "$name" |
  gzip -9 --no-name >"$dist/$name.tar.gz"
echo "$dist/$name.tar.gz: $(du -k "$dist/$name.tar.gz" | cut -f1) kB, unpacked $(du -sk "$work/$name" | cut -f1) kB"
