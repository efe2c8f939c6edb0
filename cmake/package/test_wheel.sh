#!/bin/sh
# Installs the wheel by pip in a root that has Python and NumPy only and runs the first steps of docs/python.md there:
#   test_wheel.sh ROOT WHEEL    ROOT is the folder of a Debian with python3-venv, python3-numpy and /proc; needs root
set -eu

root=$(realpath "$1")
wheel=$2
# A folder of a user, with a space in its name.
home="/srv/my programs"
rm -rf "$root$home"
mkdir -p "$root$home"
cp "$wheel" "$root$home/"

# Every installed file is the one of RECORD, which pip does not compare.
cat >"$root$home/record.py" <<'EOF'
import base64, hashlib, importlib.metadata
files = importlib.metadata.files("poise")
hashed = [file for file in files if file.hash]
for file in hashed:
    digest = hashlib.new(file.hash.mode, file.locate().read_bytes()).digest()
    assert base64.urlsafe_b64encode(digest).rstrip(b"=").decode() == file.hash.value, file
assert any("libipopt-" in file.name for file in hashed) and any(file.name == "README.txt" for file in hashed)
print(len(hashed), "files are those of RECORD")
EOF
cat >"$root$home/steps.py" <<'EOF'
import numpy as np
import poise
clamp = poise.example("toggle_clamp")
rest = clamp.solve()
rest.save("clamp.svg")
print(rest.verdict)
assert rest.proved and "</svg>" in open("clamp.svg").read()
assert clamp.solve(method="energy").proved
assert abs(clamp.path("load.P", 0, 60).folds[0]["load.P"] - 37.0934) < 1e-4
assert clamp.solve_many({"load.P": np.linspace(0, 36, 10_000)}, of="force.rubber").solved.all()
assert poise.identify(poise.example_path("lift_experiment"))
EOF

inside() {
  begin=$(date +%s.%N)
  chroot "$root" /bin/sh -c 'cd "$0" && exec "$@"' "$home" "$@"
  printf '%6.2f s  %s\n' "$(echo "$(date +%s.%N) $begin" | awk '{ print $1 - $2 }')" "$*"
}

inside python3 -m venv --system-site-packages venv
inside venv/bin/python -m pip install --no-index --quiet --disable-pip-version-check "$(basename "$wheel")"
inside venv/bin/python record.py
inside venv/bin/python steps.py
installed=$(du -skc "$root$home"/venv/lib/python3*/site-packages/poise* | tail -n 1 | cut -f1)
echo "test_wheel: $(du -k "$wheel" | cut -f1) kB, installed $installed kB"
rm -rf "$root$home"
