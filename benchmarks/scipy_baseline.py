"""SciPy as an external solver; external_solver.hpp has the lines it is asked and answers.

    python3 scipy_baseline.py LIBRARY      the library that evaluate_scene.cpp makes

Every method has exact derivatives at compiled speed: a callback copies x and makes one call without arguments to
convert. What could be prepared before is (multipliers of the start by least squares, buffers, options).
"""

import ctypes
import gc
import sys
import time
import warnings

try:
    import numpy as np
    import scipy.optimize as so
except ImportError as error:
    sys.stdin.readline()
    print("no", error, flush=True)
    sys.exit()


class SceneView(ctypes.Structure):
    """As in evaluate_scene.cpp."""
    _fields_ = [("n", ctypes.c_int), ("m", ctypes.c_int), ("evaluations", ctypes.c_long)] + [
        (name, ctypes.POINTER(ctypes.c_double)) for name in
        ("point", "value", "gradient", "constraint", "jacobian", "hessian", "residual", "tangent")]


class Library:
    def __init__(self, path):
        # PyDLL keeps the interpreter's lock, which is quicker for calls that take less than a microsecond.
        self.calls = ctypes.PyDLL(path)
        self.calls.scene_open.restype = ctypes.POINTER(SceneView)
        self.calls.scene_open.argtypes = [ctypes.c_char_p]
        for name in ("scene_close", "scene_evaluate", "scene_evaluate_hessian", "scene_evaluate_residual",
                     "scene_evaluate_tangent"):
            call = getattr(self.calls, name)
            call.restype = None
            call.argtypes = [ctypes.c_void_p]

    def __call__(self, name):
        return getattr(self.calls, name)


class Scene:
    """The callbacks that SciPy's methods want, on arrays that are views of the library's memory."""

    def __init__(self, library, name):
        opened = library("scene_open")(name.encode())
        if not opened:
            raise ValueError("the scene cannot be evaluated")
        self.view = opened.contents
        n, m = self.n, self.m = self.view.n, self.view.m
        handle = ctypes.cast(opened, ctypes.c_void_p)

        def array(field, *shape):
            return np.ctypeslib.as_array(getattr(self.view, field), shape)

        point = array("point", n + m)
        x_part, y_part = point[:n], point[n:]
        value, gradient, constraint = array("value", 1), array("gradient", n), array("constraint", m)
        jacobian, hessian = array("jacobian", m, n), array("hessian", n, n)
        residual, tangent = array("residual", n + m), array("tangent", n + m, n + m)
        evaluate, evaluate_hessian = library("scene_evaluate"), library("scene_evaluate_hessian")
        evaluate_residual, evaluate_tangent = library("scene_evaluate_residual"), library("scene_evaluate_tangent")

        def energy(x):
            x_part[:] = x
            evaluate(handle)
            return value[0]

        def force(x):
            x_part[:] = x
            evaluate(handle)
            return gradient.copy()  # minimizers keep what they are given

        def closure(x):
            x_part[:] = x
            evaluate(handle)
            return constraint.copy()

        def closure_jacobian(x):
            x_part[:] = x
            evaluate(handle)
            return jacobian.copy()

        def energy_hessian(x):
            x_part[:] = x
            y_part[:] = 0.0
            evaluate_hessian(handle)
            return hessian.copy()

        def closure_hessian(x, y):
            of_energy = energy_hessian(x)
            y_part[:] = y
            evaluate_hessian(handle)
            return hessian - of_energy

        def balance(z):  # MINPACK copies
            point[:] = z
            evaluate_residual(handle)
            return residual

        def balance_jacobian(z):
            point[:] = z
            evaluate_tangent(handle)
            return tangent

        self.energy, self.force, self.closure, self.closure_jacobian = energy, force, closure, closure_jacobian
        self.energy_hessian, self.closure_hessian = energy_hessian, closure_hessian
        self.balance, self.balance_jacobian = balance, balance_jacobian

    def forget(self):
        self.energy(np.full(self.n, np.nan))  # where the last solution ended
        self.before = self.view.evaluations

    def evaluations(self, _, times):
        return (self.view.evaluations - self.before) / times

    def start_from(self, x):
        self.x = np.array(x)
        y = np.linalg.lstsq(self.closure_jacobian(self.x).T, -self.force(self.x), rcond=None)[0]
        self.xy = np.concatenate([self.x, y])


# Each takes a scene and an accuracy, and returns what solves once: () -> OptimizeResult. The system of `root` is
# symmetric, so that col_deriv only saves a transposition.

def hybr(scene, accuracy):
    options = {"col_deriv": 1, "xtol": accuracy}
    return lambda: so.root(scene.balance, scene.xy, jac=scene.balance_jacobian, method="hybr", options=options)


def lm(scene, accuracy):
    options = {"col_deriv": 1, "xtol": accuracy, "ftol": accuracy}
    return lambda: so.root(scene.balance, scene.xy, jac=scene.balance_jacobian, method="lm", options=options)


def slsqp(scene, accuracy):
    options = {"ftol": accuracy**2, "maxiter": 1000}  # of the energy, which is flat at rest
    constraints = () if scene.m == 0 else {"type": "eq", "fun": scene.closure, "jac": scene.closure_jacobian}
    return lambda: so.minimize(scene.energy, scene.x, jac=scene.force, method="SLSQP", constraints=constraints,
                               options=options)


def trust_constr(scene, accuracy):
    options = {"gtol": accuracy, "xtol": accuracy, "maxiter": 300}
    constraints = () if scene.m == 0 else so.NonlinearConstraint(scene.closure, 0.0, 0.0, jac=scene.closure_jacobian,
                                                                 hess=scene.closure_hessian)
    return lambda: so.minimize(scene.energy, scene.x, jac=scene.force, hess=scene.energy_hessian,
                               method="trust-constr", constraints=constraints, options=options)


METHODS = {"root hybr": hybr, "root lm": lm, "SLSQP": slsqp, "trust-constr": trust_constr}


def solve(scene, method, accuracy, times):
    run = method(scene, accuracy)
    scene.forget()
    begin = time.perf_counter()
    for _ in range(times):
        found = run()
    seconds = (time.perf_counter() - begin) / times
    return " ".join([repr(seconds), str(round(scene.evaluations(found, times))), str(int(found.success)),
                     *map(repr, found.x[:scene.n].tolist())])


def idle():
    """Seconds of root() that starts at the solution of x = 1: what SciPy itself takes; the least of many."""
    x, residual, jacobian = np.ones(1), np.zeros(1), np.eye(1)
    options = {"col_deriv": 1}
    least = np.inf
    for _ in range(2000):
        begin = time.perf_counter()
        so.root(lambda _: residual, x, jac=lambda _: jacobian, method="hybr", options=options)
        least = min(least, time.perf_counter() - begin)
    return least


def serve(open_scene, methods, idle=None):
    """Answers until the input ends; `methods` are functions of a scene and an accuracy, by name."""
    warnings.simplefilter("ignore")
    gc.disable()  # as timeit does
    scene = None
    for line in sys.stdin:
        request, _, rest = line.strip().partition(" ")
        try:
            answer = ""
            if request == "methods":
                answer = "|".join(methods)
            elif request == "idle" and idle:
                answer = repr(idle())
            elif request == "scene":
                gc.collect()
                scene = open_scene(rest)
            elif request == "start":
                scene.start_from([float(word) for word in rest.split()])
            elif request == "solve":
                method, accuracy, times = rest.split()
                answer = solve(scene, list(methods.values())[int(method)], float(accuracy), int(times))
            else:
                raise ValueError("unknown request " + request)
            print("ok", answer, flush=True)
        except Exception as error:  # whatever a solver throws is its answer
            print("no", str(error).replace("\n", " "), flush=True)


if __name__ == "__main__":
    library = Library(sys.argv[1])
    serve(lambda name: Scene(library, name), METHODS, idle)
