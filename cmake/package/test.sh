#!/bin/sh
# Installs what `make package` has written in fresh roots of Debian, uses it there as its users would, and prints the
# seconds from the packages on the disk to the first result.
#   cmake/package/test.sh PACKAGES WORK [TEST]...
# TEST is debian, program, mpi, python, library, archive or wheel; all without.
# Needs root. The base of the roots and the packages that apt has fetched are kept in WORK, which makes later runs quick.
set -eu
[ "$(id -u)" -eq 0 ] || { echo "$0: needs root" >&2; exit 1; }
if [ -z "${POISE_OWN_MOUNTS:-}" ]; then
  # What is mounted for a root is seen by no other process, and gone with the last one of these.
  exec env POISE_OWN_MOUNTS=1 unshare --mount "$0" "$@"
fi
packages=$(realpath "$1")
mkdir -p "$2/archives/partial"
work=$(realpath "$2")
shift 2
source=$(realpath "$(dirname "$0")/../..")
release=$(. /etc/os-release && echo "$VERSION_CODENAME")

inside() {  # ROOT USER COMMAND: by the shell, in the folder /home of the root
  chroot --userspec="$2" "$work/$1" env -i PATH=/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/home LC_ALL=C.UTF-8 \
    DEBIAN_FRONTEND=noninteractive sh -e -c "cd /home; $3"
}

# Runs a step of the test $test; says nothing of it unless it fails.
quietly() {
  "$@" >"$work/log" 2>&1 || { cat "$work/log"; echo "$test: failed: $*"; exit 1; }
}

# The base: apt has the sources, the proxy and the checks of this machine.
targets() { apt-get indextargets --format "$1" 'Identifier: Packages' 'Origin: Debian'; }
test=base
if [ ! -e "$work/base/made" ]; then
  rm -rf "$work/base"
  eval "$(apt-config shell http_proxy Acquire::http::Proxy)"
  [ -z "${http_proxy:-}" ] || export http_proxy
  echo "base: debootstrap $release"
  quietly debootstrap --variant=minbase "$release" "$work/base" \
    "$(targets '$(CODENAME) $(REPO_URI)' | sed -n "s/^$release //p" | head -n 1)"
  rm -f "$work"/base/var/cache/apt/archives/*.deb
  touch "$work/base/made"
fi
cp /etc/resolv.conf "$work/base/etc/resolv.conf"
targets 'deb $(REPO_URI) $(CODENAME) $(COMPONENT)' | sort -u >"$work/base/etc/apt/sources.list"
{
  echo 'Acquire::Languages "none";'
  apt-config dump | grep -E '^Acquire::(http|https|Check)' || true
} >"$work/base/etc/apt/apt.conf.d/90machine"
quietly inside base 0:0 'apt-get update'

# Makes a root of the name of the test, which has PACKAGES in /packages, and installs files of it and packages of Debian.
fresh() {  # [FILE or NAME]...
  rm -rf --one-file-system "${work:?}/$test"
  cp -a "$work/base" "$work/$test"
  mkdir "$work/$test/packages"
  chown 1000:1000 "$work/$test/home"
  mount -t proc proc "$work/$test/proc"
  mount --bind "$work/archives" "$work/$test/var/cache/apt/archives"
  mount --bind "$packages" "$work/$test/packages"
  [ -n "$1" ] || return 0
  install --download-only "$1"
  started=$(date +%s.%N)
  install "" "$1"
  since "$(sed -n 's/.*, \([0-9]*\) newly installed.*/\1/p' "$work/log") packages installed, $(
    sed -n 's/^After this operation, \(.*\) of additional.*/\1/p' "$work/log")"
}

install() {  # OPTION FILES
  quietly inside "$test" 0:0 "cd /packages; apt-get install -y $1 $2"
}

user() { quietly inside "$test" 1000:1000 "$1"; }

since() { echo "$test: $1, after $(echo "$(date +%s.%N) $started" | awk '{printf "%.1f", $1 - $2}') s"; }

# The file that README.md shows after "<!-- file: NAME -->".
readme_file() {
  awk -v "mark=<!-- file: $1 -->" '$0 == mark {found = 1; next} found && /^```/ {if (inside) exit; inside = 1; next}
    inside' "$source/README.md" >"$work/$test/home/$1"
  [ -s "$work/$test/home/$1" ] || { echo "$test: README.md has no file $1"; exit 1; }
}

debian() {
  # CPack calls ldconfig for the module in lib/poise; CMake puts libraries into lib alone where the prefix is not /usr.
  quietly lintian --allow-root --fail-on error,warning \
    --suppress-tags maintscript-calls-ldconfig,pkg-config-unavailable-for-cross-compilation "$packages"/*.deb
  echo "debian: lintian finds no error and no warning"
  # What is under the GNU GPL cannot be given to others together with Ipopt.
  for file in "$packages"/poise_*.deb "$packages"/python3-poise_*.deb; do
    if dpkg-deb --field "$file" Depends | grep -E 'libcholmod|libspqr|libumfpack|libgf2x'; then
      echo "debian: $file: expected that it needs no library under the GNU GPL"
      exit 1
    fi
  done
}

program() {
  fresh './poise_*.deb'
  user 'poise solve /usr/share/poise/datasets/toggle_clamp.toml --svg first.svg; grep -q "</svg>" first.svg'
  since 'first picture'
  user 'poise view --help; gzip -t /usr/share/man/man1/poise.1.gz'
  # All commands of README.md, as they stand there; some draw charts.
  install "" gnuplot-nox
  user 'mkdir build; ln -s /usr/bin/poise build; ln -s /usr/share/poise/datasets'
  readme_file my_four_bar.toml
  sed -n 's/^\$ \(build\/poise .*\)/\1/p' "$source/README.md" >"$work/$test/home/commands"
  started=$(date +%s.%N)
  user 'sh -e commands'
  since "$(wc -l <"$work/$test/home/commands") commands of README.md"
}

mpi() {
  fresh './poise_*.deb'
  user '! OMPI_COMM_WORLD_SIZE=2 poise montecarlo /usr/share/poise/datasets/lift_experiment.toml 2>refused
    grep "install poise-mpi" refused'
  install "" './poise-mpi_*.deb'
  user 'mpirun --oversubscribe -n 2 poise montecarlo /usr/share/poise/datasets/lift_experiment.toml --trials 4 >out
    test "$(grep -c "^Lift" out)" = 1'
  since 'two ranks'
}

python() {
  fresh './python3-poise_*.deb'
  readme_file my_four_bar.toml
  cat >"$work/$test/home/first.py" <<'END'
import poise

rest = poise.load("my_four_bar.toml").solve()
assert rest.proved and poise.example("toggle_clamp").solve().proved
rest.save("first.svg")
END
  user 'python3 first.py; grep -q "</svg>" first.svg'
  since 'first picture'
  # What root has run leaves compiled files in the folder of the package, which go with it.
  quietly inside "$test" 0:0 'python3 first.py; apt-get remove -y python3-poise
    test ! -e /usr/lib/python3/dist-packages/poise'
  install "" './python3-poise_*.deb'
  quietly inside "$test" 0:0 'apt-get purge -y python3-minimal; test ! -e /usr/lib/python3/dist-packages/poise'
  echo "python: removed alone, and together with Python, without a trace"
}

library() {
  fresh './libpoise-dev_*.deb g++ cmake make'
  cmake -D "page=$source/README.md" -D program=example -D "output=$work/$test/home/example.cpp" \
    -P "$source/tests/docs/extract_program.cmake"
  cp "$source/datasets/toggle_clamp.toml" "$work/$test/home"
  cat >"$work/$test/home/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(example LANGUAGES CXX)
find_package(poise REQUIRED)
add_executable(example example.cpp)
target_link_libraries(example PRIVATE poise::poise)
END
  user 'cmake -B build; cmake --build build; build/example toggle_clamp.toml | grep "^confirmed"'
  since 'the example of README.md by CMake'
  started=$(date +%s.%N)
  user 'g++ -std=c++20 example.cpp -o example $(pkg-config --cflags --libs poise)
    ./example toggle_clamp.toml | grep "^confirmed"'
  since 'the example of README.md by pkg-config'
}

archive() {
  fresh ''
  "$source/cmake/package/test_tar.sh" "$work/$test" "$packages"/poise-*.tar.gz
}

wheel() {
  fresh 'python3-venv python3-numpy'
  "$source/cmake/package/test_wheel.sh" "$work/$test" "$packages"/poise-*.whl
}

for test in ${*:-debian program mpi python library archive wheel}; do
  $test
  [ -d "$work/$test" ] || continue
  umount "$work/$test/proc" "$work/$test/packages" "$work/$test/var/cache/apt/archives"
  rm -rf --one-file-system "${work:?}/$test"
done
