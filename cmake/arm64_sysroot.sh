#!/bin/sh
# Puts the libraries that Poise needs, as Debian builds them for arm64, into a folder, where nothing of them runs and no
# package of this machine is touched. Does nothing where they are there already.
#   cmake/arm64_sysroot.sh FOLDER
# The packages are those of cmake/dependencies.cmake that libraries, program and tests are compiled with.
set -eu

mkdir -p "$1"
folder=$(cd "$1" && pwd)
packages=$(sed -n 's/.*# apt: *//p' "$(dirname "$0")/dependencies.cmake" | tr ' ' '\n' | grep -e '-dev$' |
  grep -v -e sleef -e mpi -e python -e pybind -e benchmark -e sundials | tr '\n' ' ')

if [ "$(cat "$folder/packages" 2>/dev/null)" = "$packages" ]; then
  exit 0
fi
rm -rf "$folder"
mkdir -p "$folder/apt/lists/partial" "$folder/apt/archives/partial" "$folder/usr/lib" "$folder/usr/bin" "$folder/usr/sbin"
for name in lib bin sbin; do ln -s "usr/$name" "$folder/$name"; done
: >"$folder/apt/status"

echo "arm64_sysroot: downloading $packages (150 MB with all that they depend on)"
# As on a machine of arm64 with no package installed.
apt="apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Sandbox::User=root -o Dir::State=$folder/apt
  -o Dir::State::status=$folder/apt/status -o Dir::Cache=$folder/apt"
$apt update
$apt install -y --download-only --no-install-recommends $packages >/dev/null
for archive in "$folder"/apt/archives/*.deb; do dpkg-deb -x "$archive" "$folder"; done
rm -r "$folder/apt"

# What the alternatives of Debian choose when packages are installed.
libraries=$folder/usr/lib/aarch64-linux-gnu
for name in blas lapack; do
  for end in so so.3; do ln -sf "$name/lib$name.$end" "$libraries/lib$name.$end"; done
done
# Stands where only the compiler of arm64 itself looks.
ln -s libgfortran.so.5 "$libraries/libgfortran.so"
# Links from the root would lead out of the folder.
find "$folder" -type l -lname '/*' | while read -r link; do
  ln -sfn "$(realpath -m --relative-to="$(dirname "$link")" "$folder$(readlink "$link")")" "$link"
done
# So would the libraries that this one names.
sed -i 's|;/usr/lib/|;${CMAKE_SYSROOT}/usr/lib/|g' "$libraries/cmake/Ceres/CeresTargets.cmake"
echo "$packages" >"$folder/packages"
