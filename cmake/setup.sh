#!/bin/sh
# Installs the Debian packages that Poise needs and that are missing; changes nothing if none is missing.
#   cmake/setup.sh             what building, testing and benchmarking need
#   cmake/setup.sh lint        what `make lint` and `make format` need
#   cmake/setup.sh fuzz        what `make fuzz` needs
#   cmake/setup.sh package     what `make package` and `make package-test` need
#   cmake/setup.sh clang       what PRESET=clang needs
#   cmake/setup.sh arm64       what `make arm64` needs, but for its libraries (cmake/arm64_sysroot.sh)
#   cmake/setup.sh baselines   programs that benchmarks compare Poise with, where they are installed
#   cmake/setup.sh browser     the browser that tests of pages run in
#   cmake/setup.sh site        what `make site` needs
#   cmake/setup.sh oracles     programs that tests check Poise against, where they are installed
# The packages are those named in cmake/dependencies.cmake after "# apt:", "# apt lint:" and so on.
set -eu

purpose=${1:+ $1}
packages=$(sed -n "s/.*# apt$purpose: *//p" "$(dirname "$0")/dependencies.cmake")

if ! command -v apt-get >/dev/null; then
  echo "setup: no apt-get here; continuing with what is installed. Poise needs these packages, by their Debian names:" $packages
  exit 0
fi

missing=
for package in $packages; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}\n' "$package" 2>/dev/null) || status=
  case $status in installed*) ;; *) missing="$missing $package" ;; esac
done
if [ -z "$missing" ]; then
  exit 0
fi

as_root=
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "setup: missing packages and no sudo; as root run: apt-get install$missing" >&2
    exit 1
  fi
  as_root=sudo
fi

echo "setup: installing$missing (this may take some minutes)"
# A failing update of some other package source is no error; the installation decides.
$as_root apt-get update -qq || echo "setup: apt-get update failed; trying with the present package lists" >&2
$as_root env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 $missing >/dev/null
