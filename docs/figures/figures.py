"""Writes the drawings of this folder: /usr/bin/python3 docs/figures/figures.py, with NumPy and SciPy."""

from __future__ import annotations

from pathlib import Path

import basics
import files
import gears
import slots
import theory

DRAWINGS = (
    basics.frames, basics.section, basics.joints, basics.measures, basics.springs, basics.spring_curve,
    basics.gas_strut, basics.bump_stop, basics.loads, basics.time_functions, basics.time_ways,
    gears.gear, gears.gear_internal, gears.tooth_force, gears.belt, gears.rack, gears.coupling, gears.cam,
    gears.cam_law, gears.geneva, gears.rope, gears.chain,
    slots.circular_slot, slots.curved_slot, slots.rolling, slots.rolling_on_circle, slots.rolling_profile,
    slots.rolling_profile_on_circle, slots.hollow_rocker,
    files.stop_drive, files.sensor, files.run, files.goals, files.straight_line,
    theory.phasors, theory.settling, theory.interval_newton, theory.balance, theory.poses, theory.four_bar,
)


def main() -> None:
    for make in DRAWINGS:
        (Path(__file__).parent / f"{make.__name__}.svg").write_text(make().svg())


if __name__ == "__main__":
    main()
