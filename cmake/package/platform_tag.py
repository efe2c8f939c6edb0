"""Prints the platform of a wheel by PEP 600, manylinux_2_35_x86_64: the oldest glibc that has all that its files need.

    platform_tag.py FILE...
"""

from __future__ import annotations

import platform
import re
import subprocess
import sys

# The first glibc in whose company common distributions have a libstdc++ with these symbols: those of GCC 11 with
# glibc 2.34 (RHEL 9), of GCC 12 with 2.35 (Ubuntu 22.04), of GCC 13 with 2.38 (Fedora 39).
GLIBC_WITH_GLIBCXX = {(3, 4, 28): (2, 31), (3, 4, 29): (2, 34), (3, 4, 30): (2, 35), (3, 4, 32): (2, 38)}


def needed_versions(file: str) -> set[tuple[str, tuple[int, ...]]]:
    """The versions of symbols that a file needs: ("GLIBC", (2, 34))."""
    command = ["readelf", "--version-info", "--wide", file]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    needs = text.partition("Version needs section")[2]
    found = re.findall(r"Name: (GLIBC|GLIBCXX)_([0-9.]+)", needs)
    return {(library, tuple(int(part) for part in version.split("."))) for library, version in found}


def oldest_glibc(versions: set[tuple[str, tuple[int, ...]]]) -> tuple[int, ...]:
    glibc = [version[:2] for library, version in versions if library == "GLIBC"]
    newest = max((version for library, version in versions if library == "GLIBCXX"), default=(0,))
    for known in sorted(GLIBC_WITH_GLIBCXX):
        if newest <= known:
            return max([*glibc, GLIBC_WITH_GLIBCXX[known]])
    raise SystemExit(f"platform_tag: GLIBCXX_{'.'.join(map(str, newest))}: expected at most "
                     f"GLIBCXX_{'.'.join(map(str, max(GLIBC_WITH_GLIBCXX)))}")


def main() -> None:
    versions = set().union(*(needed_versions(file) for file in sys.argv[1:]))
    print(f"manylinux_{'_'.join(map(str, oldest_glibc(versions)))}_{platform.machine()}")


if __name__ == "__main__":
    main()
