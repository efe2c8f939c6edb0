"""The commands of ``poise --help`` as calls: written by python/generate_commands.py, not by hand.

What is common to all of them: options that are None are not given. Numbers are in the units of the scene. ``progress``
is called with a text that says what is being done, ten times a second at most. Ctrl-C stops the work of a call in the
main thread, which returns what it has. Bad input raises InputError, in the one line that the command line prints; that
nothing was found is no exception but said by the result.
"""

from __future__ import annotations

from typing import Any, Mapping, Sequence

from . import _poise
from ._found import Curve, Equilibria, Fit, Found, Motion, Tolerance
from ._run import ExperimentFile, Numbers, Path, Progress, Ranges, Settings, Variants, Words, run


class SceneCommands:
    """The commands that read a scene."""

    __slots__ = ()

    _core: _poise.Scene

    def check(
        self,
        *,
        set: Settings | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Show what a scene is: bodies, joints, mobility, what the model keeps.

        As by the command line::

            poise check datasets/six_bar.toml

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        """
        return run(Found, "check", self._core, {
            "--set": set,
        }, None, progress)

    def equilibria(
        self,
        *,
        set: Settings | None = None,
        with_: Path | Found | None = None,
        assemblies: bool = False,
        drive: Ranges | None = None,
        seconds: float | None = None,
        starts: int | None = None,
        seed: int | None = None,
        show: Words | None = None,
        jobs: int | None = None,
        proof_seconds: float | None = None,
        progress: Progress | None = None,
    ) -> Equilibria:
        """Find all equilibria, and say whether they are proved to be all.

        As by the command line::

            poise equilibria datasets/four_bar_gravity.toml --svg equilibria.svg

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        with_: Result of poise identify --json FILE: the scene takes its estimates, and
            every result gets an interval from their errors (docs/predictions.md);
            or the fit itself
        assemblies: Positions alone: all ways in which the loops close, with the drives
            held; nothing else may move
        drive: crank=30: hold the angle of a body in the world, the travel of a joint
            or a measure (length.SPRING=200) there; crank: where it stands; several
            times;
            or a dictionary, {NAME: NUMBER} or {NAME: None}
        seconds: Time for the proof that there are no others (a number of boxes, about
            a minute); 0: no proof, random starts alone
        starts: Random starts, where nothing is proved (1000)
        seed: Of the random starts (1)
        show: Quantities to show, with commas between: angle.BODY, x.BODY.POINT,
            length.ELEMENT, force.ELEMENT, reaction.JOINT, push.BODY.POINT.x,
            d(A)/d(B), energy, ..., and expressions of them (docs/quantities.md)
        jobs: Threads (0, the default: all cores); the result is the same
        proof_seconds: Time allowed for the proof of an answer, after which that is
            "checked, not proved" (a number of operations, about 10 s)
        """
        return run(Equilibria, "equilibria", self._core, {
            "--set": set,
            "--with": with_,
            "--assemblies": assemblies,
            "--drive": drive,
            "--seconds": seconds,
            "--starts": starts,
            "--seed": seed,
            "--show": show,
            "--jobs": jobs,
            "--proof-seconds": proof_seconds,
        }, None, progress)

    def hold(
        self,
        name: str | None = None,
        low: float | None = None,
        high: float | None = None,
        *,
        set: Settings | None = None,
        vary: Ranges | None = None,
        at_rest: bool = False,
        with_: Path | Found | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Whether friction holds a position, by what margin, and for which loads.

        As by the command line::

            poise hold datasets/friction/wedge.toml --vary load.P

        name, low, high: a range of ``vary``, without the word
        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        vary: The values of a number for which friction holds the position: load.P,
            body.B.mass, slide.S.friction.coefficient; loads: a factor of all loads;
            or a dictionary, {NAME: (FROM, TO)} or {NAME: None}
        at_rest: In the equilibrium without friction, not in the position as drawn
        with_: Result of poise identify --json FILE: the scene takes its estimates, and
            every result gets an interval from their errors (docs/predictions.md);
            or the fit itself
        """
        return run(Found, "hold", self._core, {
            "--set": set,
            "--vary": vary,
            "--at-rest": at_rest,
            "--with": with_,
        }, ("--vary", name, low, high), progress)

    def path(
        self,
        name: str | None = None,
        low: float | None = None,
        high: float | None = None,
        *,
        set: Settings | None = None,
        with_: Path | Found | None = None,
        vary: Ranges | None = None,
        curve: str | None = None,
        from_: str | None = None,
        follow: str | None = None,
        snap: str | None = None,
        branches: bool = False,
        search: int | None = None,
        at: Numbers | None = None,
        show: Words | None = None,
        measure: Words | None = None,
        beside: Path | Sequence[Path] | None = None,
        variant: Variants | None = None,
        proof_seconds: float | None = None,
        progress: Progress | None = None,
    ) -> Curve:
        """Follow the equilibria as a load, a dimension or a driven measure changes.

        As by the command line::

            poise path datasets/von_mises_toggle.toml --vary load.P=0..60 --svg toggle.svg

        name, low, high: a range of ``vary``, without the word
        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        with_: Result of poise identify --json FILE: the scene takes its estimates, and
            every result gets an interval from their errors (docs/predictions.md);
            or the fit itself
        vary: Vary a number of the scene, in its own units: load.P=0..5,
            spring.S.stiffness=1..3; loads=0..1 (a factor of all loads);
            angle.BODY, length.SPRING, x.BODY.POINT, ...: what is driven, with the
            effort needed;
            or a dictionary, {NAME: (FROM, TO)}
        curve: equilibria: as one number changes (the default); fold: the curve of
            folds, with its cusps, in the plane of two numbers, --vary twice
        from_: settle: where the mechanism comes to rest when released from its
            start (the default); equilibrium: the one nearest to the start
        follow: unstable: the curve through its folds (the default); jump: stable
            equilibria only, snapping at folds, there and back
        snap: settle: snaps land where the mechanism settles with heavy damping (the
            default); dynamic: show also their motion with its inertia and dampers,
            what it hits, how fast, and where it comes to rest
        branches: Follow all curves that cross at branch points too
        search: Search also for curves that are not connected with the start, by
            deflation from N starts at each of five values (0)
        at: Show the equilibria at these values of the number: 1,2.5,5;
            or a row of numbers
        show: Quantities to show, with commas between: angle.BODY, x.BODY.POINT,
            length.ELEMENT, force.ELEMENT, reaction.JOINT, push.BODY.POINT.x,
            d(A)/d(B), energy, ..., and expressions of them (docs/quantities.md)
        measure: The same, of one; several times
        beside: Follow the same number in this scene file too: one chart, and the
            differences at the values of --at; several times
        variant: The same with the scene changed: "A: load.P=3, spring.S.stiffness=2";
            several times;
            or a dictionary, {LABEL: {PATH: NUMBER}}
        proof_seconds: Time allowed for the proof of an answer, after which that is
            "checked, not proved" (a number of operations, about 10 s)
        """
        return run(Curve, "path", self._core, {
            "--set": set,
            "--with": with_,
            "--vary": vary,
            "--curve": curve,
            "--from": from_,
            "--follow": follow,
            "--snap": snap,
            "--branches": branches,
            "--search": search,
            "--at": at,
            "--show": show,
            "--measure": measure,
            "--beside": beside,
            "--variant": variant,
            "--proof-seconds": proof_seconds,
        }, ("--vary", name, low, high), progress)

    def find(
        self,
        name: str | None = None,
        low: float | None = None,
        high: float | None = None,
        for_: Settings | None = None,
        *,
        set: Settings | None = None,
        vary: Ranges | None = None,
        all: bool = False,
        from_: str | None = None,
        show: Words | None = None,
        proof_seconds: float | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Find the number for which a quantity has a value in equilibrium, and prove it.

        As by the command line::

            poise find datasets/toggle_clamp.toml --vary spring.rubber.stiffness=200..800 --for "force.rubber = -700"

        name, low, high: a range of ``vary``, without the word
        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        vary: The number that is sought and its range, in its own units: a number of
            the scene, loads, or a measure that is driven, angle.BODY or
            length.ELEMENT; twice with two --for;
            or a dictionary, {NAME: (FROM, TO)}
        for_: The quantity and the value that it is to have, in its unit
            (docs/quantities.md): "force.rubber = -700";
            or a dictionary, {Q: VALUE}
        all: Also on the curves through all equilibria at both ends of the range
            and in its middle
        from_: settle: where the mechanism comes to rest when released from its
            start (the default); equilibrium: the one nearest to the start
        show: Quantities to show, with commas between: angle.BODY, x.BODY.POINT,
            length.ELEMENT, force.ELEMENT, reaction.JOINT, push.BODY.POINT.x,
            d(A)/d(B), energy, ..., and expressions of them (docs/quantities.md)
        proof_seconds: Time allowed for the proof of an answer, after which that is
            "checked, not proved" (a number of operations, about 10 s)
        """
        return run(Found, "find", self._core, {
            "--set": set,
            "--vary": vary,
            "--for": for_,
            "--all": all,
            "--from": from_,
            "--show": show,
            "--proof-seconds": proof_seconds,
        }, ("--vary", name, low, high), progress)

    def sensitivity(
        self,
        of: Words,
        *,
        set: Settings | None = None,
        top: int | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """How much each number of a scene moves positions, forces and loads at folds.

        As by the command line::

            poise sensitivity datasets/toggle_clamp.toml --of force.rubber,fold.load.P

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        of: What to look at, with commas between: angle.BODY, travel.JOINT,
            x.BODY.POINT, length.ELEMENT, force.ELEMENT, reaction.JOINT or its
            .x, .y, .moment, .axial; stop.NAME; energy; d(A)/d(B); fold.load.LOAD, the
            load at which the mechanism snaps (docs/quantities.md)
        top: Show the N numbers that move it most (12); 0 shows all
        """
        return run(Found, "sensitivity", self._core, {
            "--set": set,
            "--of": of,
            "--top": top,
        }, None, progress)

    def tolerance(
        self,
        tolerances: Path | Mapping[str, Any] | None = None,
        of: Words | None = None,
        *,
        set: Settings | None = None,
        with_: Path | Found | None = None,
        samples: int | None = None,
        seed: int | None = None,
        jobs: int | None = None,
        progress: Progress | None = None,
    ) -> Tolerance:
        """What tolerances of dimensions, springs and loads do to an equilibrium.

        As by the command line::

            poise tolerance datasets/toggle_clamp.toml --tolerances datasets/toggle_clamp_tolerances.toml --of \
            force.rubber

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        tolerances: Half widths of numbers: [tolerances] with lines like "point.*" = 0.1;
            or a dictionary, {PATH: NUMBER}
        with_: Result of poise identify --json FILE: the scene takes its estimates, and
            every result gets an interval from their errors (docs/predictions.md);
            or the fit itself
        of: What to look at, with commas between: angle.BODY, travel.JOINT,
            x.BODY.POINT, length.ELEMENT, force.ELEMENT, reaction.JOINT or its
            .x, .y, .moment, .axial; stop.NAME; energy; d(A)/d(B); fold.load.LOAD, the
            load at which the mechanism snaps (docs/quantities.md)
        samples: Draw N samples (100000); 0: first and second order only
        seed: Seed of the samples (1)
        jobs: Threads; 0: all cores (the default). Results do not depend on it
        """
        return run(Tolerance, "tolerance", self._core, {
            "--set": set,
            "--tolerances": tolerances,
            "--with": with_,
            "--of": of,
            "--samples": samples,
            "--seed": seed,
            "--jobs": jobs,
        }, None, progress)

    def loads(
        self,
        name: str | None = None,
        low: float | None = None,
        high: float | None = None,
        *,
        set: Settings | None = None,
        seek: str | None = None,
        steps: int | None = None,
        vary: Ranges | None = None,
        time: float | None = None,
        show: Words | None = None,
        proof_seconds: float | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Find internal forces, moments, stresses and deflections of links.

        As by the command line::

            poise loads datasets/structures/three_hinged_portal.toml --svg loads.svg

        name, low, high: a range of ``vary``, without the word
        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        seek: settle: the equilibrium that the mechanism reaches from its start
            when released with heavy damping (the default); any: any
            equilibrium near the start (minimising methods find minima only);
            stable: minima only
        steps: Equal parts of each piece of a diagram in JSON and CSV, or of the
            range of --vary (10)
        vary: Over a range of a number or of a driven measure (load.P=0..40,
            angle.BODY=0..90): the smallest and largest force of every joint and
            the largest loads of links, and where;
            or a dictionary, {NAME: (FROM, TO)}
        time: In motion, S seconds after the scene's start, with the inertia of
            the links (without it: at rest in the equilibrium)
        show: Quantities to show, with commas between: angle.BODY, x.BODY.POINT,
            length.ELEMENT, force.ELEMENT, reaction.JOINT, push.BODY.POINT.x,
            d(A)/d(B), energy, ..., and expressions of them (docs/quantities.md)
        proof_seconds: Time allowed for the proof of an answer, after which that is
            "checked, not proved" (a number of operations, about 10 s)
        """
        return run(Found, "loads", self._core, {
            "--set": set,
            "--seek": seek,
            "--steps": steps,
            "--vary": vary,
            "--time": time,
            "--show": show,
            "--proof-seconds": proof_seconds,
        }, ("--vary", name, low, high), progress)

    def compare(
        self,
        *,
        set: Settings | None = None,
        seek: str | None = None,
        methods: Words | None = None,
        scaling: float | None = None,
        penalty: float | None = None,
        proof_seconds: float | None = None,
        tolerances: Numbers | None = None,
        repeat: int | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Find an equilibrium by several methods side by side.

        As by the command line::

            poise compare datasets/car_hood.toml --svg hood.svg

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        seek: settle: the equilibrium that the mechanism reaches from its start
            when released with heavy damping (the default); any: any
            equilibrium near the start (minimising methods find minima only);
            stable: minima only
        methods: virtual-work,energy (the default), any other list of names, or
            all (the default with --tolerances). With a list it is enough
            for exit code 0 that one is confirmed.
            virtual-work: Newton-Raphson on the equations of virtual work
            energy: minimum energy, by Ipopt
            augmented-lagrangian: Newton on the augmented Lagrangian
            augmented-lagrangian-modified: the same without the curvature of the constraints, as in MECANO
            slsqp: minimum energy by sequential quadratic programming (NLopt)
            auglag-lbfgs: minimum energy by an augmented Lagrangian around L-BFGS (NLopt)
            cobyla: minimum energy without derivatives (NLopt)
            dynamic-relaxation: damped fictitious motion
            least-squares: least squares of the residuals of all equations, by Ceres
        scaling: Of the augmented Lagrangian V + k lambda c + p/2 c^2: k > 0 (1),
            which changes rounding alone
        penalty: Of the augmented Lagrangian: p >= 0, in units in which forces and
            lengths of the mechanism are about 1 (10)
        proof_seconds: Time allowed for the proof of an answer, after which that is
            "checked, not proved" (a number of operations, about 10 s)
        tolerances: Speed against error: runs at these tolerances, by decades
            (1e-2..1e-14) or as a list (1e-3,1e-6); --svg then draws the
            error against the time; exit code 0 where some run is confirmed;
            or a row of numbers
        repeat: Runs of each to take the median time of (7)
        """
        return run(Found, "compare", self._core, {
            "--set": set,
            "--seek": seek,
            "--methods": methods,
            "--scaling": scaling,
            "--penalty": penalty,
            "--proof-seconds": proof_seconds,
            "--tolerances": tolerances,
            "--repeat": repeat,
        }, None, progress)

    def kinematics(
        self,
        name: str | None = None,
        low: float | None = None,
        high: float | None = None,
        *,
        set: Settings | None = None,
        drive: Ranges | None = None,
        steps: int | None = None,
        rate: float | None = None,
        point: Words | None = None,
        show: Words | None = None,
        all: bool = False,
        progress: Progress | None = None,
    ) -> Found:
        """Drive a mechanism over a range: positions, velocities, accelerations.

        As by the command line::

            poise kinematics datasets/lift.toml --drive stroke=0.5..0.79 --point platform.Q --svg lift.svg

        name, low, high: a range of ``drive``, without the word
        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        drive: Drive the angle of a body in the world, the travel of a joint or
            a measure, in the scene's units: crank=0..360,
            length.SPRING=200..145, x.BODY.POINT=..., angle.BODY.OTHER=...;
            one for each degree of freedom; ends where a stop is met;
            or a dictionary, {NAME: (FROM, TO)}
        steps: Equal parts of the range (72)
        rate: Speed of the first drive that moves, scene's units per second
            (1 rad/s or 1 m/s)
        point: Show this point: crank.B; --svg draws its path; several times
        show: Quantities to show, with commas between: angle.BODY, x.BODY.POINT,
            length.ELEMENT, force.ELEMENT, reaction.JOINT, push.BODY.POINT.x,
            d(A)/d(B), energy, ..., and expressions of them (docs/quantities.md)
        all: Show every angle and slide too
        """
        return run(Found, "kinematics", self._core, {
            "--set": set,
            "--drive": drive,
            "--steps": steps,
            "--rate": rate,
            "--point": point,
            "--show": show,
            "--all": all,
        }, ("--drive", name, low, high), progress)

    def motion(
        self,
        duration: float,
        *,
        set: Settings | None = None,
        with_: Path | Found | None = None,
        rate: float | None = None,
        release: Settings | None = None,
        release_rate: Settings | None = None,
        from_: str | None = None,
        seek: str | None = None,
        noise: float | None = None,
        seed: int | None = None,
        accuracy: float | None = None,
        show: Words | None = None,
        forces: bool = False,
        motors: Words | None = None,
        events: Path | None = None,
        progress: Progress | None = None,
    ) -> Motion:
        """Simulate free or driven motion, from equilibrium or from a displaced position.

        As by the command line::

            poise motion datasets/lift.toml --duration 2 --release obd=0.005 --csv swing.csv

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        with_: Result of poise identify --json FILE: the scene takes its estimates, and
            every result gets an interval from their errors (docs/predictions.md);
            or the fit itself
        duration: Duration of the motion, s
        rate: Samples per second of the record (1000)
        release: Start with this body turned, or joint moved, by so much from the
            pose of --from, in the scene's units; several times;
            or a dictionary, {NAME: NUMBER}
        release_rate: The same with a speed, per second;
            or a dictionary, {NAME: NUMBER}
        from_: equilibrium: the one near the start (the default without drives and
            controllers);
            start: as it is assembled (the default with them)
        seek: settle: the equilibrium that the mechanism reaches from its start
            when released with heavy damping (the default); any: any
            equilibrium near the start (minimising methods find minima only);
            stable: minima only
        noise: Standard deviation of Gaussian noise added to the angles and
            travels of --csv, in the scene's units
        seed: Of the noise (1)
        accuracy: Relative accuracy of the motion (1e-10)
        show: Quantities to show, with commas between: angle.BODY, x.BODY.POINT,
            length.ELEMENT, force.ELEMENT, reaction.JOINT, push.BODY.POINT.x,
            d(A)/d(B), energy, ..., and expressions of them (docs/quantities.md)
        forces: At every instant of the record the forces of drives with their power
            and work, of joints and elements, of inertia, and internal loads of
            links: columns of --csv, largest values, charts
        motors: Torques of pins or forces along slides, with commas between, that make
            the motion in place of the drives, which say what it is to be;
            implies --forces
        events: Write the events at stops, contacts and ropes to FILE as CSV, one line
            each: impact, rest, lift-off, stick, slide
        """
        return run(Motion, "motion", self._core, {
            "--set": set,
            "--with": with_,
            "--duration": duration,
            "--rate": rate,
            "--release": release,
            "--release-rate": release_rate,
            "--from": from_,
            "--seek": seek,
            "--noise": noise,
            "--seed": seed,
            "--accuracy": accuracy,
            "--show": show,
            "--forces": forces,
            "--motors": motors,
            "--events": events,
        }, None, progress)

    def modes(
        self,
        *,
        set: Settings | None = None,
        seek: str | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Find small oscillations about equilibrium: frequencies, shapes, damping.

        As by the command line::

            poise modes datasets/lift.toml

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        seek: settle: the equilibrium that the mechanism reaches from its start
            when released with heavy damping (the default); any: any
            equilibrium near the start (minimising methods find minima only);
            stable: minima only
        """
        return run(Found, "modes", self._core, {
            "--set": set,
            "--seek": seek,
        }, None, progress)

    def response(
        self,
        excite: str,
        of: Words,
        *,
        set: Settings | None = None,
        from_: float | None = None,
        to: float | None = None,
        steps: int | None = None,
        amplitude: float | None = None,
        at: str | None = None,
        seek: str | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Find amplitude and phase over the frequency of what swings about an equilibrium.

        As by the command line::

            poise response datasets/forced_machine.toml --excite load.F --of y.machine.C --svg response.svg

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        excite: What swings as a cosine: a load, load.NAME, a number of a spring, say
            spring.NAME.free_length, or controller.NAME.reference (docs/response.md)
        of: What answers: x.BODY.POINT, angle.BODY, travel.JOINT, length.ELEMENT,
            force.ELEMENT, d(A)/dt, or an expression of them (docs/quantities.md)
        from_: Lowest frequency (a tenth of the lowest natural frequency)
        to: Highest frequency (three times the highest natural frequency)
        steps: Frequencies between, on a logarithmic scale (200)
        amplitude: Amplitude of a load, in its unit: follow the periodic motions, which
            may fold and jump, in place of the response to first order
        at: Frequencies, Hz, of which all periodic motions are listed
        seek: settle: the equilibrium that the mechanism reaches from its start
            when released with heavy damping (the default); any: any
            equilibrium near the start (minimising methods find minima only);
            stable: minima only
        """
        return run(Found, "response", self._core, {
            "--set": set,
            "--excite": excite,
            "--of": of,
            "--from": from_,
            "--to": to,
            "--steps": steps,
            "--amplitude": amplitude,
            "--at": at,
            "--seek": seek,
        }, None, progress)

    def running(
        self,
        *,
        set: Settings | None = None,
        turning: str | None = None,
        turns: int | None = None,
        speed: float | None = None,
        show: Words | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Find how a machine with motors runs steadily: speed over a turn, forces, stability.

        As by the command line::

            poise running datasets/machines/motor_slider_crank.toml --svg running.svg

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        turning: The body whose turns make the period (that of the first motor)
        turns: Turns of it in a period (1)
        speed: Start at this rate of it, in the scene's unit of angle per second;
            without it from rest, where the motors have to start it
        show: Quantities to show, with commas between: angle.BODY, x.BODY.POINT,
            length.ELEMENT, force.ELEMENT, reaction.JOINT, push.BODY.POINT.x,
            d(A)/d(B), energy, ..., and expressions of them (docs/quantities.md)
        """
        return run(Found, "running", self._core, {
            "--set": set,
            "--turning": turning,
            "--turns": turns,
            "--speed": speed,
            "--show": show,
        }, None, progress)

    def forces(
        self,
        name: str | None = None,
        low: float | None = None,
        high: float | None = None,
        *,
        set: Settings | None = None,
        drive: Ranges | None = None,
        rate: float | None = None,
        lift_off: Words | None = None,
        flywheel: float | None = None,
        steps: int | None = None,
        motion: Path | Found | None = None,
        show: Words | None = None,
        with_: Path | Found | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Find the forces of drives and joints, in a position or along a motion.

        As by the command line::

            poise forces datasets/lift.toml --drive stroke=0.5..0.79 --svg forces.svg

        name, low, high: a range of ``drive``, without the word
        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        drive: crank: drives the angle of a body in the world, the travel of a
            joint or a measure (length.SPRING, x.BODY.POINT,
            angle.BODY.OTHER) from where it stands; crank=30: put there;
            crank=0..360: over a range, as far as stops allow. Takes the
            place of the scene's drives; several times;
            or a dictionary, {NAME: (FROM, TO)}, {NAME: NUMBER} or {NAME: None}
        rate: Move at this speed, scene's units per second, with all inertia
            (without it: standing still in every position)
        lift_off: Over a range: the smallest rate of the drive at which this cam,
            rope or chain would have to pull, and where; of a guided cam that
            at which it changes sides; several times
        flywheel: Over whole turns at --rate: the fluctuation of the torque of the
            drive, and the flywheel that holds (largest - least speed) / mean
            to this number, say 0.02
        steps: Equal parts of the range (72)
        motion: Take the motion from FILE, a CSV with the columns time, NAME
            and perhaps NAME.rate, as poise motion writes it;
            or the motion itself
        show: Quantities to show, with commas between: angle.BODY, x.BODY.POINT,
            length.ELEMENT, force.ELEMENT, reaction.JOINT, push.BODY.POINT.x,
            d(A)/d(B), energy, ..., and expressions of them (docs/quantities.md)
        with_: Result of poise identify --json FILE: the scene takes its estimates, and
            every result gets an interval from their errors (docs/predictions.md);
            or the fit itself
        """
        return run(Found, "forces", self._core, {
            "--set": set,
            "--drive": drive,
            "--rate": rate,
            "--lift-off": lift_off,
            "--flywheel": flywheel,
            "--steps": steps,
            "--motion": motion,
            "--show": show,
            "--with": with_,
        }, ("--drive", name, low, high), progress)

    def equations_of_motion(
        self,
        *,
        set: Settings | None = None,
        at: Settings | None = None,
        rate: Settings | None = None,
        time: float | None = None,
        from_: str | None = None,
        seek: str | None = None,
        coordinates: Words | None = None,
        code: Path | None = None,
        python: Path | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Hand out the equation of motion: as numbers, as C and as Python.

        As by the command line::

            poise equations datasets/double_pendulum.toml --from start --code pendulum.c --python pendulum.py

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        at: Where this body or joint is: its angle in the world or its travel,
            in the scene's units; several times;
            or a dictionary, {NAME: NUMBER}
        rate: Its speed, per second; several times;
            or a dictionary, {NAME: NUMBER}
        time: Time at which loads and drives are taken, s (0)
        from_: Where everything else is. equilibrium: in the one near the start (the
            default without drives); start: as it is assembled (the default with
            drives)
        seek: settle: the equilibrium that the mechanism reaches from its start
            when released with heavy damping (the default); any: any
            equilibrium near the start (minimising methods find minima only);
            stable: minima only
        coordinates: The coordinates z of the equation, with commas between; those that are
            missing, or all, are chosen
        code: Write functions in C99 to FILE
        python: Write the same in Python to FILE
        """
        return run(Found, "equations", self._core, {
            "--set": set,
            "--at": at,
            "--rate": rate,
            "--time": time,
            "--from": from_,
            "--seek": seek,
            "--coordinates": coordinates,
            "--code": code,
            "--python": python,
        }, None, progress)

    def export(
        self,
        *,
        set: Settings | None = None,
        pose: Words | None = None,
        dxf: Path | None = None,
        pmks: Path | None = None,
        urdf: Path | None = None,
        mjcf: Path | None = None,
        progress: Progress | None = None,
    ) -> Found:
        """Write a scene as files of other programs.

        As by the command line::

            poise export datasets/six_bar.toml --dxf six_bar.dxf

        set: Change a number of the scene, in its own units: load.P=40,
            body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
            can be given several times;
            or a dictionary, {PATH: NUMBER}
        pose: Where the mechanism is written: start (the default), equilibrium, or the
            file of poise path --json, with all its positions; of a drawing several,
            with commas between
        dxf: Write to FILE: drawing in DXF, each link on its layer
        pmks: Write to FILE: address of PMKS+
        urdf: Write to FILE: URDF of ROS, in one plane
        mjcf: Write to FILE: MJCF of MuJoCo, in one plane
        """
        return run(Found, "export", self._core, {
            "--set": set,
            "--pose": pose,
            "--dxf": dxf,
            "--pmks": pmks,
            "--urdf": urdf,
            "--mjcf": mjcf,
        }, None, progress)


def design(
    design: Path,
    *,
    seed: int | None = None,
    starts: int | None = None,
    method: str | None = None,
    trade_off: int | None = None,
    scene: Path | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Found:
    """Find numbers that meet the goals of a design file.

    As by the command line::

        poise design datasets/wall_bed_design.toml --scene found.toml --html design.html

    design: Design file (TOML)
    seed: Of the random starts (1)
    starts: Searches before it gives up (300; of [[goal]] 100)
    method: Of aims: slsqp (the default), mma or auglag
    trade_off: So many points of the trade-off of two aims
    scene: Write what was found to FILE, as a scene
    jobs: Threads of the search; the answer is the same for any number
    """
    return run(Found, "design", None, {
        "DESIGN": design,
        "--seed": seed,
        "--starts": starts,
        "--method": method,
        "--trade-off": trade_off,
        "--scene": scene,
        "--jobs": jobs,
    }, None, progress)


def identify(
    experiment: ExperimentFile | Sequence[ExperimentFile],
    *,
    data: Path | None = None,
    set: Settings | None = None,
    start: str | None = None,
    continue_: Path | Found | None = None,
    quick: bool = False,
    thorough: bool = False,
    bootstrap: int | None = None,
    profile: Words | None = None,
    accept_misfit: bool = False,
    scene: Path | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Estimate masses, inertias, stiffnesses and damping from measured motions.

    As by the command line::

        poise identify datasets/lift_experiment.toml --svg fit.svg

    experiment: Experiment file (TOML); of several, models of the same readings are
        compared;
        or an Experiment
    data: Read this CSV file in place of the one that the experiment's
        runs name (all the same)
    set: Change a number of the scene, in its own units: load.P=40,
        body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
        can be given several times;
        or a dictionary, {PATH: NUMBER}
    start: auto: from damped sines where the records are such oscillations,
        else from the experiment's starts (the default); given: from those
        always
    continue_: Go on from what an interrupted fit had reached: its --json FILE
    quick: Leave out what puts the minimum in question: the cost away from
        it, other minima, fits without a run
    thorough: Put the minimum in question however long that takes, not only
        for a fifth of the work of the fit
    bootstrap: Refit N records resampled from blocks of the residuals, for standard
        errors that assume no model of them
    profile: Find the profile likelihood of an unknown, and its 95 % interval;
        can be given several times
    accept_misfit: Exit with 0 although residuals are above 3 times the noise, or
        records have faults that are named
    scene: Write the scene with the estimates in place to FILE
    jobs: Threads for the motions of the runs and for profiles (0,
        the default: all cores)
    """
    return run(Fit, "identify", None, {
        "EXPERIMENT": experiment,
        "--data": data,
        "--set": set,
        "--start": start,
        "--continue": continue_,
        "--quick": quick,
        "--thorough": thorough,
        "--bootstrap": bootstrap,
        "--profile": profile,
        "--accept-misfit": accept_misfit,
        "--scene": scene,
        "--jobs": jobs,
    }, None, progress)


def validate(
    experiment: ExperimentFile,
    with_: Path | Found,
    *,
    data: Path | None = None,
    set: Settings | None = None,
    starts: str | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Found:
    """Predict other records with the parameters of a fit, and compare.

    As by the command line::

        poise validate datasets/lift_experiment.toml --with fit.json

    experiment: Experiment file (TOML);
        or an Experiment
    data: Read this CSV file in place of the one that the experiment's
        runs name (all the same)
    set: Change a number of the scene, in its own units: load.P=40,
        body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
        can be given several times;
        or a dictionary, {PATH: NUMBER}
    with_: Result of poise identify --json FILE: its estimates are taken as
        they are, by the names of the unknowns;
        or the fit itself
    starts: fitted: start and equilibrium of every run are fitted to its record
        (the default); measured: starts follow from the first readings
    jobs: Threads for the motions of the runs (0, the default:
        all cores)
    """
    return run(Found, "validate", None, {
        "EXPERIMENT": experiment,
        "--data": data,
        "--set": set,
        "--with": with_,
        "--starts": starts,
        "--jobs": jobs,
    }, None, progress)


def identifiability(
    experiment: ExperimentFile,
    *,
    data: Path | None = None,
    set: Settings | None = None,
    base: bool = False,
    progress: Progress | None = None,
) -> Found:
    """Find which parameters an experiment determines, before any fit.

    As by the command line::

        poise identifiability datasets/lift_experiment_empty.toml

    experiment: Experiment file (TOML);
        or an Experiment
    data: Read this CSV file in place of the one that the experiment's
        runs name (all the same)
    set: Change a number of the scene, in its own units: load.P=40,
        body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
        can be given several times;
        or a dictionary, {PATH: NUMBER}
    base: List the base parameters of the mechanism, too
    """
    return run(Found, "identifiability", None, {
        "EXPERIMENT": experiment,
        "--data": data,
        "--set": set,
        "--base": base,
    }, None, progress)


def plan(
    experiment: ExperimentFile,
    *,
    data: Path | None = None,
    set: Settings | None = None,
    seed: int | None = None,
    for_: str | None = None,
    in_: Path | None = None,
    jobs: int | None = None,
    experiment_: Path | None = None,
    progress: Progress | None = None,
) -> Found:
    """Choose the runs of an experiment that determine its parameters best.

    As by the command line::

        poise plan datasets/lift_plan.toml --experiment planned.toml

    experiment: Experiment file (TOML);
        or an Experiment
    data: Read this CSV file in place of the one that the experiment's
        runs name (all the same)
    set: Change a number of the scene, in its own units: load.P=40,
        body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
        can be given several times;
        or a dictionary, {PATH: NUMBER}
    seed: Of the runs that are tried (1)
    for_: Make the standard error of this result smallest: fold.load.P, force.S,
        ... (docs/quantities.md), in place of the criterion of [plan]
    in_: The scene that --for is a result of; else that of the experiment
    jobs: Threads (0, the default: all cores)
    experiment_: Write the experiment with the planned runs to FILE
    """
    return run(Found, "plan", None, {
        "EXPERIMENT": experiment,
        "--data": data,
        "--set": set,
        "--seed": seed,
        "--for": for_,
        "--in": in_,
        "--jobs": jobs,
        "--experiment": experiment_,
    }, None, progress)


def montecarlo(
    experiment: ExperimentFile,
    *,
    data: Path | None = None,
    set: Settings | None = None,
    trials: int | None = None,
    seed: int | None = None,
    start_error: float | None = None,
    start: str | None = None,
    jobs: int | None = None,
    output: Path | None = None,
    resume: bool = False,
    shard: str | None = None,
    progress: Progress | None = None,
) -> Found:
    """Simulate and fit many times, to verify the standard errors of the estimates.

    As by the command line::

        poise montecarlo datasets/lift_experiment.toml --trials 300

    experiment: Experiment file (TOML);
        or an Experiment
    data: Read this CSV file in place of the one that the experiment's
        runs name (all the same)
    set: Change a number of the scene, in its own units: load.P=40,
        body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;
        can be given several times;
        or a dictionary, {PATH: NUMBER}
    trials: Simulations to fit (300)
    seed: Seed of the noise and of the starts (1)
    start_error: Every fit starts from parameters that differ from the truth by
        up to this part of it, drawn at random (0.5)
    start: given: from those (the default); auto: from damped sines
        where the records oscillate so
    jobs: Threads, of each rank under mpirun (0, the default: all
        cores)
    output: Keep every trial in files of this new folder (docs/studies.md)
    resume: Go on with what --output DIR has
    shard: Only part i = 1 .. N of the trials, into --output DIR: for job
        arrays; --resume without it then completes and merges all parts
    """
    return run(Found, "montecarlo", None, {
        "EXPERIMENT": experiment,
        "--data": data,
        "--set": set,
        "--trials": trials,
        "--seed": seed,
        "--start-error": start_error,
        "--start": start,
        "--jobs": jobs,
        "--output": output,
        "--resume": resume,
        "--shard": shard,
    }, None, progress)


def import_(
    file: Path,
    *,
    format: str | None = None,
    units: str | None = None,
    tolerance: float | None = None,
    scene: Path | None = None,
    progress: Progress | None = None,
) -> Found:
    """Read a file of another program as a scene.

    As by the command line::

        poise import datasets/exchange/four_bar.txt --scene four_bar.toml

    file: File of another program (docs/exchange.md)
    format: What the file is; without it its ending says so
        dxf (.dxf): drawing in DXF, each link on its layer
        pmks (.url): address of PMKS+
        pmks-text (.txt): list of joints of PMKS
        linkage2 (.linkage2): file of Linkage
        urdf (.urdf): URDF of ROS, in one plane
        mjcf (.xml): MJCF of MuJoCo, in one plane
    units: Unit of its lengths where the file names none: m, mm, in or ft
        (docs/exchange.md has the default of each format)
    tolerance: Distance at which two points of a drawing are one, in its unit (a
        millionth of its size)
    scene: Write the scene to FILE; without it the scene is printed
    """
    return run(Found, "import", None, {
        "FILE": file,
        "--format": format,
        "--units": units,
        "--tolerance": tolerance,
        "--scene": scene,
    }, None, progress)


def stress(
    case: Words | None = None,
    *,
    list: bool = False,
    catalogue: Path | None = None,
    methods: Words | None = None,
    starts: int | None = None,
    work: float | None = None,
    seconds: float | None = None,
    jobs: int | None = None,
    safeguards: bool = False,
    progress: Progress | None = None,
) -> Found:
    """Run all methods on the hard catalogue, from many starts.

    As by the command line::

        poise stress --methods virtual-work,energy --starts 100

    case: Cases to try and to show in detail (all, on one sheet)
    list: Only list the cases
    catalogue: Folder of the catalogue (datasets/hard, or Poise's own); its
        format: docs/hard-cases.md
    methods: all (the default), or names with commas between
        virtual-work: Newton-Raphson on the equations of virtual work
        energy: minimum energy, by Ipopt
        augmented-lagrangian: Newton on the augmented Lagrangian
        augmented-lagrangian-modified: the same without the curvature of the constraints, as in MECANO
        slsqp: minimum energy by sequential quadratic programming (NLopt)
        auglag-lbfgs: minimum energy by an augmented Lagrangian around L-BFGS (NLopt)
        cobyla: minimum energy without derivatives (NLopt)
        dynamic-relaxation: damped fictitious motion
        least-squares: least squares of the residuals of all equations, by Ceres
    starts: Starts per case (its own number)
    work: Methods other than virtual-work try no further starts of a
        case after N evaluations of a small mechanism (200000)
    seconds: The same after S seconds in place of --work: the number of
        starts depends on the machine then
    jobs: Threads, which take the cases (1, since times are measured; 0
        for all cores)
    safeguards: Virtual work alone: with all its safeguards, and with each
        switched off in turn
    """
    return run(Found, "stress", None, {
        "CASE": case,
        "--list": list,
        "--catalogue": catalogue,
        "--methods": methods,
        "--starts": starts,
        "--work": work,
        "--seconds": seconds,
        "--jobs": jobs,
        "--safeguards": safeguards,
    }, None, progress)


#: The commands that are functions.
FUNCTIONS = (
    "design",
    "identify",
    "validate",
    "identifiability",
    "plan",
    "montecarlo",
    "import_",
    "stress",
)
