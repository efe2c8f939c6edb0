#!/bin/sh
# Packs the Python module with its libraries into a wheel that pip installs where none of them is:
#   wheel.sh BUILD DIST    writes DIST/poise-VERSION-cpXY-cpXY-manylinux_2_Z_ARCH.whl from a finished build folder
# The name says the oldest glibc with which it runs, by the versions of symbols that it needs.
set -eu

build=$(realpath "$1")
mkdir -p "$2"
dist=$(realpath "$2")
here=$(dirname "$(realpath "$0")")
python=$(sed -n 's/^Python_EXECUTABLE:.*=//p' "$build/CMakeCache.txt")

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
(cd "$here/../.." && POISE_BUILD_FOLDER=$build "$python" setup.py --quiet bdist_wheel --dist-dir "$work") \
  >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
"$python" -m wheel unpack --dest "$work" "$work"/poise-*.whl >"$work/log"
folder=$(echo "$work"/poise-*/)
information=$(echo "$folder"poise-*.dist-info)
module=$(echo "$folder"poise/_poise.*.so)

# What every machine has that manylinux means stays out (PEP 600).
"$python" "$here/bundle_libraries.py" --hashed-names --keep-out libstdc++.so.6 --keep-out libgcc_s.so.1 \
  --into "${folder}poise.libs" --licences "$information/licenses" "$module"
# What an index shows of README.md, and the page of the datasets.
"$python" -B "$here/drop_dead_links.py" "$information/METADATA" "$folder"
platform=$("$python" "$here/platform_tag.py" "$module" "${folder}poise.libs"/*)
sed -i "s/^\(Tag: .*\)-linux_.*/\1-$platform/" "$information/WHEEL"
"$python" -m wheel pack --dest-dir "$dist" "$folder" >"$work/log"
wheel=$(ls -t "$dist"/poise-*"$platform".whl | head -n 1)
echo "$wheel: $(du -k "$wheel" | cut -f1) kB, installed $(du -sk "$folder" | cut -f1) kB"
