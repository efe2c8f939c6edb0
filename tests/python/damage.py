"""Records of known rigs, sound or damaged, and what `poise identify` says of them.

    python3 damage.py PROGRAM [--seed N] [--only WORD]            damaged records: every kind once
    python3 damage.py PROGRAM --sound COUNT [--seed N]            sound records: COUNT experiments of each rig

The rigs move by equations written here (Runge and Kutta's method), so that this judge owes nothing to what it judges,
and of that it reads only what it prints. What must come of a damage is stated beside what it does to the record, and
follows from that alone:

    harmless     exit 0, and the true values are where the estimates allow: not beyond twice the 95 % interval
    named        exit 1 or 2, and one of these expressions is found in a line before the estimates: the cause, or what
                 has the same effect on these readings exactly
    untellable   the damaged readings are those of another mechanism among those that the unknowns allow, so that
                 nothing in them tells

A sound record must be harmless.
"""

import argparse
import collections
import dataclasses
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parents[2]
DEGREE = np.pi / 180


# --- rigs ---------------------------------------------------------------------------------------------------------

@dataclasses.dataclass
class Rig:
    """A scene, what its experiment says, and how it moves: rate(t, q, v) is the acceleration."""
    scene: str
    unknowns: dict          # path: (name, truth, start)
    sensors: list           # (name, table, deviation of a reading, its value of q and v)
    starts: list            # q of each run at time 0, where it stands still
    bodies: list            # of the scene, whose release is q
    acceleration: object
    duration: float
    rate: float
    stated: bool            # the noise of the sensors
    torque: object = None   # of time, as its column says
    digit: float = 0.0      # that readings are rounded to
    dry: float = 0.0        # friction over inertia, which acts beside `acceleration` and may hold a single body

    @property
    def names(self):
        return [sensor[0] for sensor in self.sensors]

    @property
    def columns(self):
        return self.names + (["tau"] if self.torque else [])


ARM = """gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0] }
mass = 1.2
center = [0.3, 0]
inertia = 0.02
[[pin]]
points = ["ground.O", "arm.O"]
[[torsion_damper]]
name = "bearing"
bodies = ["ground", "arm"]
coefficient = 0.05
[start]
arm = -1.5707963267948966
"""
MOTOR = """[[torque]]
name = "motor"
on = "arm"
value = 0
"""
RUBS = """[[friction]]
name = "seal"
bodies = ["ground", "arm"]
torque = 0.1
width = 0.05
"""
J = {"body.arm.inertia": ("J", 0.02, 0.03)}
C = {"torsion_damper.bearing.coefficient": ("c", 0.05, 0.03)}


def torque(t):
    return 0.9 * np.sin(2 * np.pi * 0.45 * t) + 0.6 * np.sin(2 * np.pi * 1.9 * t + 1)


def arm(motor, friction=0.0, most=np.inf):
    def acceleration(t, q, v):
        drive = np.clip(torque(t), -most, most) if motor else 0.0
        return (drive - 1.2 * 9.81 * 0.3 * np.cos(q) - 0.05 * v - friction * np.tanh(v / 0.05)) / (0.02 + 1.2 * 0.09)
    return acceleration


def swing(**changed):
    """A free arm: its inertia and damping from its swings. How well it is read is not stated."""
    return Rig(scene=ARM, unknowns=J | C, sensors=[("phi", 'angle = "arm"', 1e-3, lambda q, v: q[0])],
               starts=[[-0.77], [-2.1]], bodies=["arm"], acceleration=arm(False), duration=6, rate=200,
               **{"stated": False} | changed)


def driven(saturates=False, **changed):
    """An arm with a motor, its angle and a gyro; the place of its centre is unknown too."""
    most = 0.8 if saturates else np.inf
    return Rig(scene=ARM.replace("[start]", MOTOR + "[start]"),
               unknowns=J | C | {"body.arm.center.x": ("a", 0.3, 0.28)},
               sensors=[("phi", 'angle = "arm"', 1e-3, lambda q, v: q[0]),
                        ("gyro", 'angle = "arm"\nrate = true', 5e-3, lambda q, v: v[0])],
               starts=[[-1.2], [-1.9]], bodies=["arm"], acceleration=arm(True, most=most), duration=6, rate=200,
               torque=torque, **{"stated": True} | changed)


def rubbing(saturates=False, **changed):
    """A driven arm with dry friction, of unknown torque."""
    most = 0.8 if saturates else np.inf
    return Rig(scene=ARM.replace("[start]", MOTOR + RUBS + "[start]"),
               unknowns=J | C | {"friction.seal.torque": ("T", 0.1, 0.05)},
               sensors=[("phi", 'angle = "arm"', 1e-3, lambda q, v: q[0])],
               starts=[[-1.2], [-1.9]], bodies=["arm"], acceleration=arm(True, friction=0.1, most=most), duration=6,
               rate=200, torque=torque, **{"stated": False} | changed)


def double(**changed):
    """Two arms, free, of the size of measured ones."""
    text = (SOURCE / "datasets" / "double_pendulum.toml").read_text()
    scene = tomllib.loads(text)
    one, two = scene["body"]["arm1"], scene["body"]["arm2"]
    c1, c2 = (damper["coefficient"] for damper in scene["torsion_damper"])
    length = one["points"]["elbow"][0]
    a = one["inertia"] + one["mass"] * one["center"][0] ** 2 + two["mass"] * length**2
    b = two["inertia"] + two["mass"] * two["center"][0] ** 2
    c = two["mass"] * length * two["center"][0]
    d = one["mass"] * one["center"][0] + two["mass"] * length
    g = -scene["gravity"][1]

    def acceleration(t, q, v):
        cosine, sine = np.cos(q[0] - q[1]), np.sin(q[0] - q[1])
        elbow = -c2 * (v[1] - v[0])
        right = [-c * sine * v[1] ** 2 - d * g * np.cos(q[0]) - c1 * v[0] - elbow,
                 c * sine * v[0] ** 2 - c / length * g * np.cos(q[1]) + elbow]
        return np.linalg.solve([[a, c * cosine], [c * cosine, b]], right)

    return Rig(scene=text,
               unknowns={"body.arm1.inertia": ("J1", one["inertia"], 6e-4),
                         "body.arm2.inertia": ("J2", two["inertia"], 1e-3),
                         "torsion_damper.shoulder.coefficient": ("c1", c1, 1e-4)},
               sensors=[("phi1", 'angle = "arm1"', 1.5e-3, lambda q, v: q[0]),
                        ("phi2", 'angle = "arm2"', 1.5e-3, lambda q, v: q[1])],
               starts=[[-0.7, -1.1], [-2.0, -0.9]], bodies=["arm1", "arm2"], acceleration=acceleration, duration=4,
               rate=250, **{"stated": True} | changed)


def cart(**changed):
    """A cart on a spring, whose travel is read in mm; its mass is known."""
    return Rig(scene="""[ground]
points = { O = [0, 0] }
[body.cart]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "rail"
points = ["ground.O", "cart.C"]
axis = [1, 0]
[[spring]]
name = "coil"
slide = "rail"
stiffness = 180
free_length = 0.02
[[damper]]
name = "film"
slide = "rail"
coefficient = 1.1
[start]
rail = 0.02
""",
               unknowns={"spring.coil.stiffness": ("k", 180, 150), "damper.film.coefficient": ("c", 1.1, 0.8)},
               sensors=[("x", 'travel = "rail"\nfactor = 0.001', 0.1, lambda q, v: 1e3 * q[0])],
               starts=[[0.08], [-0.03]], bodies=["rail"],
               acceleration=lambda t, q, v: (-180 * (q - 0.02) - 1.1 * v) / 2, duration=5, rate=200,
               **{"stated": True} | changed)


def sticking(**changed):
    """A free arm with dry friction that comes to rest and stays there; an encoder of 2 mrad reads it."""
    return Rig(scene=ARM.replace("[start]", RUBS.replace("width = 0.05", "width = 0") + "[start]"),
               unknowns=J | C | {"friction.seal.torque": ("T", 0.1, 0.08)},
               sensors=[("phi", 'angle = "arm"', 3e-4, lambda q, v: q[0])],
               starts=[[-0.77], [-2.1]], bodies=["arm"], acceleration=arm(False), duration=7, rate=200, digit=2e-3,
               dry=0.1 / (0.02 + 1.2 * 0.09), **{"stated": True} | changed)


RIGS = {"swing": swing, "driven": driven, "rubbing": rubbing, "double": double, "cart": cart, "sticking": sticking}


def motion(rig, start):
    """q and v at the times of the readings."""
    finer = 5
    if rig.dry:
        return sticking_motion(rig, start[0], 10 * finer)
    h = 1 / (finer * rig.rate)
    q, v, out = np.array(start, float), np.zeros(len(start)), []
    for i in range(int(rig.duration * rig.rate) + 1):
        out.append((q, v))
        for k in range(finer):
            t = i / rig.rate + k * h
            a1 = np.asarray(rig.acceleration(t, q, v))
            a2 = np.asarray(rig.acceleration(t + h / 2, q + h / 2 * v, v + h / 2 * a1))
            a3 = np.asarray(rig.acceleration(t + h / 2, q + h / 2 * v + h * h / 4 * a1, v + h / 2 * a2))
            a4 = np.asarray(rig.acceleration(t + h, q + h * v + h * h / 2 * a2, v + h * a3))
            q = q + h * v + h * h / 6 * (a1 + a2 + a3)
            v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return out


def sticking_motion(rig, q, finer):
    """The same of one body with dry friction: the side to which it slides changes where it has come to a halt."""
    out, v, side = [], 0.0, 0.0
    for i in range(int(rig.duration * rig.rate) + 1):
        out.append((np.array([q]), np.array([v])))
        for _ in range(finer):
            left = 1 / (finer * rig.rate)
            while left > 0:
                if v == 0.0:
                    pull = rig.acceleration(0, q, 0.0)
                    if abs(pull) <= rig.dry:
                        break
                    side = np.sign(pull)
                a = rig.acceleration(0, q, v) - side * rig.dry
                b = rig.acceleration(0, q + left / 2 * v, v + left / 2 * a) - side * rig.dry
                if side * (v + left * b) >= 0:
                    q, v, left = q + left * v + left * left / 2 * a, v + left * b, 0.0
                else:
                    halt = -v / b
                    q, v, left = q + halt * v / 2, 0.0, left - halt
    return out


class Records:
    """What was logged of each run of a rig: files of columns, the time first."""

    def __init__(self, rig, random, correlation=0.0):
        self.rig, self.random = rig, random
        self.files = []
        for start in rig.starts:
            states = motion(rig, start)
            time = np.arange(len(states)) / rig.rate
            file = {"time": time}
            for name, _, deviation, value in rig.sensors:
                true = np.array([value(q, v) for q, v in states])
                file[name] = true + deviation * self.noise(len(time), correlation)
                if rig.digit:
                    file[name] = rig.digit * np.round(file[name] / rig.digit)
            if rig.torque:
                file["tau"] = rig.torque(time)
            self.files.append(file)

    def noise(self, count, correlation=0.0):
        out = self.random.standard_normal(count)
        for i in range(1, count):
            out[i] = correlation * out[i - 1] + np.sqrt(1 - correlation**2) * out[i]
        return out

    def write(self, folder):
        (folder / "scene.toml").write_text(self.rig.scene)
        text = 'scene = "scene.toml"\n'
        for name, table, deviation, _ in self.rig.sensors:
            unit = 1e-3 if "factor = 0.001" in table else 1.0
            text += f'[[sensor]]\nname = "{name}"\n{table}\n'
            text += f"noise = {unit * np.hypot(deviation, self.rig.digit / 12**0.5):.6g}\n" if self.rig.stated else ""
        for path, (name, _, start) in self.rig.unknowns.items():
            text += f'[[unknown]]\npath = "{path}"\nname = "{name}"\nstart = {start}\n'
        for r, file in enumerate(self.files):
            text += f'[[run]]\nname = "run {r + 1}"\ndata = "run{r + 1}.csv"\n'
            text += 'inputs = { "load.motor" = "tau" }\n' if self.rig.torque else ""
            rows = [",".join("" if np.isnan(cell) else f"{cell:.9g}" for cell in row) for row in zip(*file.values())]
            (folder / f"run{r + 1}.csv").write_text("\n".join([",".join(file), *rows]) + "\n")
        (folder / "experiment.toml").write_text(text)


# --- damage -------------------------------------------------------------------------------------------------------

@dataclasses.dataclass
class Damage:
    rig: str
    kind: str
    hurt: object                # changes Records
    named: tuple = ()           # expressions; none: the damage must be harmless
    untellable: str = ""        # why

    @property
    def title(self):
        return f"{self.rig}, {self.kind}"


def column(name, change):
    def hurt(records):
        for file in records.files:
            file[name] = change(file[name])
    return hurt


def both(*hurts):
    return lambda records: [hurt(records) for hurt in hurts] and None


def drop(file, rows):
    for name in file:
        file[name] = np.delete(file[name], rows)


def late(name, rows):
    """The column has what the quantity was so many readings before."""
    def hurt(records):
        for file in records.files:
            shifted = file[name][:-rows].copy()
            drop(file, np.s_[:rows])
            file[name] = shifted
    return hurt


def sometimes(name, one_in, change):
    def hurt(records):
        for file in records.files:
            at = records.random.random(len(file[name])) * one_in < 1
            file[name] = np.where(at, change(file[name]), file[name])
    return hurt


def stretch(name, part, of):
    """The column of the first run keeps one value."""
    def hurt(records):
        values = records.files[0][name]
        first, last = int(part * len(values)), int((part + of) * len(values))
        values[first:last] = values[first]
    return hurt


def clipped(name, part):
    def hurt(records):
        for file in records.files:
            low, high = file[name].min(), file[name].max()
            file[name] = np.minimum(file[name], high - part * (high - low))
    return hurt


def stands(records, name, place, count):
    deviation = dict((sensor[0], sensor[2]) for sensor in records.rig.sensors).get(name, 0.0)
    return place + deviation * records.noise(count)


def idle(seconds):
    """The logger starts so long before the motion of the first run."""
    def hurt(records):
        file, rows = records.files[0], int(seconds * records.rig.rate)
        for name in records.rig.columns:
            file[name] = np.concatenate([stands(records, name, file[name][:1].mean(), rows), file[name]])
        file["time"] = np.arange(len(file["time"]) + rows) / records.rig.rate
    return hurt


def held(part):
    """Somebody holds it from then on."""
    def hurt(records):
        file = records.files[0]
        first = int(part * len(file["time"]))
        for name in records.rig.columns:
            file[name][first:] = stands(records, name, file[name][first], len(file[name]) - first)
    return hurt


def lost(rows, seamless):
    """Rows of the first run are lost; its clock counts the rows that are left if seamless."""
    def hurt(records):
        file = records.files[0]
        time, at = file["time"], int(0.45 * len(file["time"]))
        drop(file, np.s_[at:at + rows])
        if seamless:
            file["time"] = time[:len(file["time"])]
    return hurt


def jump(seconds):
    def hurt(records):
        time = records.files[0]["time"]
        time[int(0.45 * len(time)):] += seconds
    return hurt


def numbered(first):
    return lambda records: [file.update(time=first + np.arange(len(file["time"]))) for file in records.files] and None


def exchange(a, b):
    def hurt(records):
        for file in records.files:
            file[a], file[b] = file[b], file[a]
    return hurt


def backwards(records):
    for name in records.rig.names:
        records.files[-1][name] = records.files[-1][name][::-1].copy()


def relative(a, b):
    def hurt(records):
        for file in records.files:
            file[b] = file[b] - file[a]
    return hurt


def averaged(name, over):
    def change(values):
        out = values.copy()
        for i in range(over - 1, len(values)):
            out[i] = values[i - over + 1:i + 1].mean()
        return out
    return column(name, change)


def twice(records):
    for name, values in records.files[0].items():
        records.files[0][name] = np.insert(values, 99, values[99])


def swapped_rows(records):
    for values in records.files[0].values():
        values[[99, 100]] = values[[100, 99]]


def uneven(records):
    for file in records.files:
        file["time"] = file["time"] + 0.01 / records.rig.rate * records.random.standard_normal(len(file["time"]))


def drift(name, rate):
    def hurt(records):
        for file in records.files:
            file[name] = file[name] + rate * file["time"]
    return hurt


def noisier(name, deviation):
    def hurt(records):
        for file in records.files:
            file[name] = file[name] + deviation * records.noise(len(file[name]))
    return hurt


def nothing(records):
    pass


def times(factor):
    return lambda values: factor * values


def plus(by):
    return lambda values: values + by


def wrapped(period, by):
    return lambda values: np.mod(by * (values + 1.5), period)


def sensor(name, *words):
    """The cause is said of this sensor."""
    return tuple(f'sensor "{name}" {word}' for word in words)


SEVERAL_TIMES = ("multiply time_factor", "time_factor = ")
LOST = ("readings were lost, or the clock stood still",)
JUMPED = ("clock jumped",)
OTHER_MOTION = 'run "run 2" is another motion'


def swings():
    rig, name = "swing", "phi"
    # -phi is phi of the arm mirrored at the vertical, -pi - phi, plus pi: a zero that is off by pi is the same.
    yield Damage(rig, "sign", column(name, times(-1)), (*sensor(name, "counts the other way"), r"zero = -?3\.1[34]"))
    yield Damage(rig, "degrees", column(name, times(1 / DEGREE)), sensor(name, "has another unit, by pi/180"))
    yield Damage(rig, "turns", column(name, times(1 / (2 * np.pi))), sensor(name, "has another unit, by 2 pi(?!/)"))
    yield Damage(rig, "thousandths", column(name, times(1e3)), sensor(name, "has another unit, by a thousandth"))
    yield Damage(rig, "gain 1.3", column(name, times(1.3)), sensor(name, "has another factor"))
    yield Damage(rig, "zero", column(name, plus(0.2)), (f'zero of the sensor "{name}" is off',))
    yield Damage(rig, "late", late(name, 4))
    yield Damage(rig, "clock 2 % fast", column("time", times(1.02)), SEVERAL_TIMES,
                 "the inertia and damping of an arm that swings more slowly")
    yield Damage(rig, "clock jumps", jump(0.15), JUMPED)
    yield Damage(rig, "lost, seamless", lost(30, True), LOST)
    yield Damage(rig, "lost", lost(40, False))
    yield Damage(rig, "milliseconds", column("time", times(1e3)), ("time_factor = 0.001",))
    yield Damage(rig, "minutes", column("time", times(1 / 60)), ("time_factor = 60",))
    yield Damage(rig, "tenths of seconds", column("time", times(10)), SEVERAL_TIMES,
                 "the inertia and damping of an arm that swings more slowly")
    yield Damage(rig, "row numbers", numbered(0), ("numbers of readings",))
    yield Damage(rig, "row numbers from 1", numbered(1), ("numbers of readings",))
    yield Damage(rig, "wrapped", column(name, wrapped(2 * np.pi, 1)), ("add wraps = 6.283",))
    yield Damage(rig, "wrapped degrees", column(name, wrapped(360, 1 / DEGREE)), ("add wraps = 360",))
    yield Damage(rig, "clipped", clipped(name, 0.15), ("are cut off at",))
    yield Damage(rig, "stuck", stretch(name, 0.4, 0.1), ("stand still at",))
    yield Damage(rig, "marker -9999", sometimes(name, 100, lambda v: 0 * v - 9999), (r"missing = \[-9999\]",))
    yield Damage(rig, "marker 0", sometimes(name, 100, lambda v: 0 * v), (r"missing = \[0\]",))
    yield Damage(rig, "idle", idle(0.7), ("stands still until",))
    yield Damage(rig, "held at the end", held(0.6), (r"the last \d+ % of the records are something else",))
    yield Damage(rig, "another motion", backwards, (OTHER_MOTION,))
    yield Damage(rig, "spikes", sometimes(name, 150, plus(3.7)), ("wild",))
    yield Damage(rig, "digits of 2 mrad", column(name, lambda v: 2e-3 * np.round(v / 2e-3)))
    # The first 14 readings are no means, and so earlier than the others.
    yield Damage(rig, "averaged", averaged(name, 15), ("the first 5 % of the records are something else",),
                 "the mean over 15 readings is a shift in time, and 0.2 % of the amplitude")
    yield Damage(rig, "gaps", sometimes(name, 100, lambda v: np.nan * v), ("found a gap",))
    yield Damage(rig, "row twice", twice, ("expected a time after that of the row before",))
    yield Damage(rig, "rows exchanged", swapped_rows, ("expected a time after that of the row before",))
    yield Damage(rig, "uneven clock", uneven)
    yield Damage(rig, "clock of the day", column("time", plus(86400)))
    yield Damage(rig, "runs exchanged", lambda records: records.files.reverse())
    yield Damage(rig, "drift", drift(name, 0.05), (f'zero of the sensor "{name}" drifts',))
    yield Damage(rig, "more noise", noisier(name, 2e-3))


def drivens():
    rig = "driven"
    motor = 'input "load.motor" '
    yield Damage(rig, "sign", column("phi", times(-1)), sensor("phi", "counts the other way"))
    yield Damage(rig, "sign, gyro", column("gyro", times(-1)), sensor("gyro", "counts the other way"))
    yield Damage(rig, "signs", both(column("phi", times(-1)), column("gyro", times(-1))),
                 ("all angles count the other way",))
    yield Damage(rig, "sign, motor", column("tau", times(-1)), (motor + "counts the other way",))
    yield Damage(rig, "degrees", column("phi", times(1 / DEGREE)), sensor("phi", "has another unit, by pi/180"))
    yield Damage(rig, "degrees, gyro", column("gyro", times(1 / DEGREE)), sensor("gyro", "has another unit, by pi/180"))
    yield Damage(rig, "turns per minute", column("gyro", times(60 / (2 * np.pi))),
                 sensor("gyro", "has another unit, by 2 pi/60"))
    yield Damage(rig, "thousandths, gyro", column("gyro", times(1e3)),
                 sensor("gyro", "has another unit, by a thousandth"))
    yield Damage(rig, "thousandths, motor", column("tau", times(1e3)), (motor + "has another unit, by a thousandth",))
    yield Damage(rig, "thousands, motor", column("tau", times(1e-3)), (motor + r"has another unit, by a thousand\b",))
    yield Damage(rig, "gain 1.3, motor", column("tau", times(1.3)), (motor + "has another factor",))
    yield Damage(rig, "gain 1.01, motor", column("tau", times(1.01)), (motor + "has another factor",),
                 "an arm with 1 % more of its moments and damping")
    yield Damage(rig, "exchanged", exchange("phi", "gyro"), ('columns of "phi" and "gyro" are exchanged',))
    yield Damage(rig, "zero", column("phi", plus(0.2)), ('zero of the sensor "phi" is off',))
    yield Damage(rig, "zero, gyro", column("gyro", plus(0.2)), ('zero of the sensor "gyro" is off',))
    yield Damage(rig, "zero, motor", column("tau", plus(0.3)), (f"zero of the {motor}is off",))
    yield Damage(rig, "late", late("phi", 4), sensor("phi", "is late or early"))
    yield Damage(rig, "late, gyro", late("gyro", 4), sensor("gyro", "is late or early"))
    yield Damage(rig, "late, motor", late("tau", 5), (motor + "is early or late",))
    # By the clock of the log inertia and damping are others, so that only the gyro's seconds are wrong.
    yield Damage(rig, "clock 2 % fast", column("time", times(1.02)),
                 ("the clock is fast or slow", *sensor("gyro", "has another factor")))
    yield Damage(rig, "clock jumps", jump(0.15), JUMPED)
    yield Damage(rig, "lost, seamless", lost(30, True), LOST)
    yield Damage(rig, "clipped, gyro", clipped("gyro", 0.15), ("are cut off at",))
    yield Damage(rig, "stuck, gyro", stretch("gyro", 0.3, 0.05), ("stand still at",))
    yield Damage(rig, "constant gyro", stretch("gyro", 0, 1.1), ('readings of "gyro" in run "run 1" are',))
    yield Damage(rig, "marker 65535", sometimes("gyro", 100, lambda v: 0 * v + 65535), (r"missing = \[65535\]",))
    yield Damage(rig, "saturates", nothing, (motor + "saturates",))
    yield Damage(rig, "another motion", backwards, (OTHER_MOTION,))


def doubles():
    rig, name = "double", "phi2"
    yield Damage(rig, "sign", column(name, times(-1)), sensor(name, "counts the other way"))
    yield Damage(rig, "signs", both(column("phi1", times(-1)), column(name, times(-1))),
                 ("all angles count the other way",))
    yield Damage(rig, "degrees", both(column("phi1", times(1 / DEGREE)), column(name, times(1 / DEGREE))),
                 ("all angles have another unit, by pi/180",))
    yield Damage(rig, "exchanged", exchange("phi1", name), ('columns of "phi1" and "phi2" are exchanged',))
    yield Damage(rig, "from the other arm", relative("phi1", name), sensor(name, 'counts from "arm1"'))
    yield Damage(rig, "zero", column(name, plus(0.2)), (f'zero of the sensor "{name}" is off',))
    # Nothing but the sensors tells the time: one that is late is the other that is early.
    yield Damage(rig, "late", late(name, 4), (*sensor(name, "is late or early"), *sensor("phi1", "is late or early")))
    yield Damage(rig, "clipped", clipped(name, 0.15), ("are cut off at",))
    yield Damage(rig, "lost, seamless", lost(30, True), LOST)
    yield Damage(rig, "idle", idle(0.7), ("stands still until",))
    yield Damage(rig, "clock 2 % fast", column("time", times(1.02)), ("the clock is fast or slow",))
    yield Damage(rig, "another motion", backwards, (OTHER_MOTION,))


def carts():
    rig, name = "cart", "x"
    # About the rest that is known, 20 mm: a length that is 0.02 m less, and counted backwards.
    yield Damage(rig, "sign", column(name, times(-1)),
                 (*sensor(name, "counts the other way"), f'zero of the sensor "{name}" is off'))
    yield Damage(rig, "gain 1.3", column(name, times(1.3)),
                 (*sensor(name, "has another factor"), f'zero of the sensor "{name}" is off'))
    yield Damage(rig, "gain 1.3 about rest", column(name, lambda v: 20 + 1.3 * (v - 20)))
    yield Damage(rig, "zero", column(name, plus(15)), (f'zero of the sensor "{name}" is off',))
    yield Damage(rig, "milliseconds", column("time", times(1e3)), ("time_factor = 0.001",))
    yield Damage(rig, "clipped", clipped(name, 0.15), ("are cut off at",))
    yield Damage(rig, "stuck", stretch(name, 0.3, 0.06), ("stand still at",))
    yield Damage(rig, "marker -999", sometimes(name, 60, lambda v: 0 * v - 999), (r"missing = \[-999\]",))
    yield Damage(rig, "clock jumps", jump(0.15), JUMPED)
    yield Damage(rig, "lost", lost(40, False))


def rubbings():
    rig, motor = "rubbing", 'input "load.motor" '
    yield Damage(rig, "sign, motor", column("tau", times(-1)), (motor + "counts the other way",))
    yield Damage(rig, "thousandths, motor", column("tau", times(1e3)), (motor + "has another unit, by a thousandth",))
    yield Damage(rig, "zero, motor", column("tau", plus(0.3)), (f"zero of the {motor}is off",))
    yield Damage(rig, "degrees", column("phi", times(1 / DEGREE)), sensor("phi", "has another unit, by pi/180"))
    yield Damage(rig, "saturates", nothing, (motor + "saturates",))
    yield Damage(rig, "digits of 2 mrad", column("phi", lambda v: 2e-3 * np.round(v / 2e-3)))


DAMAGES = [*swings(), *drivens(), *doubles(), *carts(), *rubbings()]


# --- judgement ----------------------------------------------------------------------------------------------------

@dataclasses.dataclass
class Judged:
    outcome: str    # "harmless", "named", "untellable", "not named", "wrong"
    words: str

    @property
    def is_right(self):
        return self.outcome in ("harmless", "named", "untellable")


def ask(program, records):
    """Exit code, what is said before the estimates, and the values that are not among those that these allow."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        records.write(folder)
        done = subprocess.run([program, "identify", "experiment.toml", "--json", "found.json"], cwd=folder,
                              capture_output=True, text=True, check=False)
        said = done.stderr + done.stdout.split("\nEstimates\n")[0]
        apart = []
        if done.returncode == 0:
            estimates = json.loads((folder / "found.json").read_text())["estimates"]
            assert len(estimates) == len(records.rig.unknowns)
            for estimate, (name, truth, _) in zip(estimates, records.rig.unknowns.values(), strict=True):
                assert estimate["name"] == name
                value, low, high = (estimate[key] for key in ("value", "low", "high"))
                if value is None:
                    continue  # withheld: nothing was said of it
                if not value - 2 * (value - low) <= truth <= value + 2 * (high - value):
                    apart.append(f"{name} = {value:.5g}, {low:.5g} to {high:.5g}, for {truth:.5g}")
        return done.returncode, said, apart


def judge(program, damage, seed):
    rig = RIGS[damage.rig](**{"saturates": True} if damage.kind == "saturates" else {})
    records = Records(rig, np.random.default_rng(seed))
    damage.hurt(records)
    code, said, apart = ask(program, records)
    if code == 0:
        outcome = "harmless" if not apart else "untellable" if damage.untellable else "wrong"
        return Judged(outcome, "; ".join(apart))
    is_named = any(re.search(words, line) for words in damage.named for line in said.splitlines())
    return Judged("named" if is_named else "not named", f"exit {code}: " + " | ".join(said.split("\n")))


def sound(rigs, seed, count):
    """Sound experiments of each rig: with white noise and with correlated noise, stated and not, in turn."""
    for i in range(count):
        for n, name in enumerate(rigs):
            correlation, stated = (0.0, 0.9)[i % 2], i // 2 % 2 == 0
            random = np.random.default_rng([seed, i, n])
            rig = RIGS[name](stated=stated)
            rig.starts = [[q + 0.15 * random.uniform(-1, 1) * (0.1 if name == "cart" else 1) for q in start]
                          for start in rig.starts]
            larger = 10 ** random.uniform(-0.5, 1)  # of the noise
            rig.sensors = [(s, table, larger * deviation, value) for s, table, deviation, value in rig.sensors]
            title = f"{name}, {'correlated' if correlation else 'white'}, {'' if stated else 'not '}stated"
            yield f"{title}, {larger:.2g} of the noise", Records(rig, random, correlation)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--sound", type=int, default=0)
    given = parser.parse_args()
    program = str(pathlib.Path(given.program).resolve())
    counts = collections.Counter()
    if given.sound:
        for title, records in sound([name for name in RIGS if given.only in name], given.seed, given.sound):
            code, said, apart = ask(program, records)
            outcome = "refused" if code else "apart" if apart else "harmless"
            counts[outcome] += 1
            if outcome != "harmless":
                print(f"{title}: {outcome}: {'; '.join(apart)} {said if code else ''}", flush=True)
        print(f"{counts.total()} sound records: {counts['harmless']} harmless, {counts['refused']} refused, "
              f"{counts['apart']} with a value beyond twice its interval")
        return 1 if counts["refused"] else 0
    wrong = False
    for damage in DAMAGES:
        if given.only not in damage.title:
            continue
        judged = judge(program, damage, given.seed)
        counts[judged.outcome] += 1
        wrong = wrong or not judged.is_right
        print(f"{damage.title:<30} {judged.outcome:<10} {judged.words[:600]}", flush=True)
    print(f"{counts.total()} kinds of damage: " + ", ".join(f"{number} {what}" for what, number in counts.items()))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
