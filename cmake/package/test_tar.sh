#!/bin/sh
# Unpacks the archive in a root that has none of its libraries and runs the first commands of README.md there:
#   test_tar.sh ROOT TAR    ROOT is the folder of a minimal Debian with /proc; needs root
set -eu

root=$(realpath "$1")
archive=$2
# A folder of a user, with a space in its name.
home="/srv/my programs"
rm -rf "$root$home"
mkdir -p "$root$home"
tar --extract --file "$archive" --directory "$root$home"
poise=$(echo "$root$home"/poise-*)
poise=${poise#"$root"}

fail() {
  echo "test_tar: $*" >&2
  exit 1
}

# Runs the program there and expects its exit code 0 and a text in what it prints.
expect() {
  expected=$1
  shift
  begin=$(date +%s.%N)
  printed=$(chroot "$root" /bin/sh -c 'cd "$0" && exec "$@" 2>&1' "$home" "$poise/bin/poise" "$@") ||
    fail "poise $*: exit code $?: $printed"
  case $printed in *"$expected"*) ;; *) fail "poise $*: expected \"$expected\", found: $printed" ;; esac
  printf '%6.2f s  poise %s\n' "$(echo "$(date +%s.%N) $begin" | awk '{ print $1 - $2 }')" "$*"
}

share=$poise/share/poise
awk '/^<!-- file: my_four_bar.toml -->/ { inside = 1 } inside && /^```$/ { exit } inside && !/^(<!--|```)/' \
  "$root$share/README.md" >"$root$home/my_four_bar.toml"
expect "  $share" --help
expect "In equilibrium, proved: stable." solve my_four_bar.toml --svg my_four_bar.svg
expect "virtual-work and energy agree" compare my_four_bar.toml
expect "3 equilibria, complete, proved." equilibria "$share/datasets/toggle_clamp.toml" --html clamp.html
expect "Converged" identify "$share/datasets/lift_experiment.toml" --quiet
for file in my_four_bar.svg clamp.html; do
  [ -s "$root$home/$file" ] || fail "expected $file"
done
for file in share/man/man1/poise.1 share/poise/docs/scene-files.md share/poise/licences/README.txt; do
  [ -s "$root$poise/$file" ] || fail "expected $file in the archive"
done

# Under mpirun it advises what fits an archive, not packages of Debian.
refused=$(chroot "$root" env OMPI_COMM_WORLD_SIZE=2 "$poise/bin/poise" montecarlo \
  "$share/datasets/lift_experiment.toml" 2>&1) && fail "expected that ranks without MPI are refused"
case $refused in
  *poise-mpi*) fail "expected no advice to install a package, found: $refused" ;;
  *"build Poise with Open MPI"*) ;;
  *) fail "expected the advice to build Poise with Open MPI, found: $refused" ;;
esac

# Of the machine only glibc is used.
foreign=$(chroot "$root" ldd "$poise/bin/poise" | grep -F ' => ' | grep -v -F " => $poise/" |
  grep -v -E '^\s*lib(c|m|mvec|dl|rt|pthread)\.so\.[0-9]+ ') || true
[ -z "$foreign" ] || fail "expected libraries of the archive, found $foreign"

echo "test_tar: $(du -k "$archive" | cut -f1) kB, unpacked $(du -sk "$root$poise" | cut -f1) kB"
rm -rf "$root$home"
