"""SciPy on equations written by hand in NumPy, as an external solver: what one would write without Poise.

    python3 numpy_baseline.py

Two mechanisms, in the units of their files in datasets/, with the absolute angles of their three bodies as coordinates.
`root` solves the balance of forces with multipliers, which start with those of least squares, `minimize` finds the
least energy; each with derivatives written by hand, and with SciPy's differences.
"""


import scipy_baseline

import numpy as np
import scipy.optimize as so


class FourBar:
    """thesis_four_bar.toml: in, lbf."""
    length = np.array([4.0, 6.0, 7.0])
    span = np.array([11.515108, 0.0])
    # Energy -(right cos q + up sin q): what forces move right and up with each link.
    right = length * [-13.29 / 2 + 10, 10, 10 / 2]
    up = length * [50, 50 / 2, 0]
    stops, least = np.zeros((0, 3)), np.zeros(0)

    def energy(self, q):
        return -(self.right @ np.cos(q) + self.up @ np.sin(q))

    def gradient(self, q):
        return self.right * np.sin(q) - self.up * np.cos(q)

    def hessian(self, q):
        return np.diag(self.right * np.cos(q) + self.up * np.sin(q))

    def closure(self, q):
        return np.array([self.length @ np.cos(q), self.length @ np.sin(q)]) - self.span

    def closure_jacobian(self, q):
        return np.array([-self.length * np.sin(q), self.length * np.cos(q)])

    def closure_hessian(self, q, y):
        return np.diag(-self.length * (y[0] * np.cos(q) + y[1] * np.sin(q)))


class ToggleClamp:
    """toggle_clamp.toml: mm, N; handle, link, arm. Its rubber only presses. Stops: over centre, and of the open arm."""
    # Vectors round the loop C, D, B, A, along and across each body, and C - A.
    along, across = np.array([24.0, 36.0, 36.0]), np.array([0.0, 0.0, -4.0])
    base = np.array([-36.0, -56.0])
    pull, stiffness, free_length = 25.0, 400.0, 14.0
    weight = 9.81 * np.array([0.28, 0.06, 0.34])
    # Heights that weights and pull lift: rise sin q + fall cos q.
    rise = np.array([26 * weight[0] + 24 * weight[1] - 40 * pull, 18 * weight[1], 24 * weight[2]])
    fall = np.array([48 * weight[0] - 118 * pull, 0.0, -weight[2]])
    tip, work = np.array([86.0, -18.0]), np.array([86.0, -30.0])  # from A
    stops = np.array([[-1.0, 1.0, 0.0], [0.0, 0.0, -1.0]])  # stops @ q >= least
    least = np.radians([-6.0, -32.0])

    def rubber(self, angle):
        """Energy of the rubber and its derivatives by the angle of the arm."""
        c, s = np.cos(angle), np.sin(angle)
        turned = np.array([c * self.tip[0] - s * self.tip[1], s * self.tip[0] + c * self.tip[1]])
        apart = turned - self.work
        length = np.sqrt(apart @ apart)
        by = min(length - self.free_length, 0.0)
        if by == 0.0:
            return 0.0, 0.0, 0.0
        slope = (apart[1] * turned[0] - apart[0] * turned[1]) / length
        bend = (self.tip @ self.tip - apart @ turned - slope**2) / length
        return (0.5 * self.stiffness * by**2, self.stiffness * by * slope,
                self.stiffness * (slope**2 + by * bend))

    def energy(self, q):
        return self.rise @ np.sin(q) + self.fall @ np.cos(q) + self.rubber(q[2])[0]

    def gradient(self, q):
        g = self.rise * np.cos(q) - self.fall * np.sin(q)
        g[2] += self.rubber(q[2])[1]
        return g

    def hessian(self, q):
        h = np.diag(-self.rise * np.sin(q) - self.fall * np.cos(q))
        h[2, 2] += self.rubber(q[2])[2]
        return h

    def closure(self, q):
        c, s = np.cos(q), np.sin(q)
        return np.array([self.along @ c - self.across @ s, self.along @ s + self.across @ c]) + self.base

    def closure_jacobian(self, q):
        c, s = np.cos(q), np.sin(q)
        return np.array([-self.along * s - self.across * c, self.along * c - self.across * s])

    def closure_hessian(self, q, y):
        c, s = np.cos(q), np.sin(q)
        return np.diag(-y[0] * (self.along * c - self.across * s) - y[1] * (self.along * s + self.across * c))


class Scene:
    """A mechanism with a start, and its balance. `root` knows no inequalities: one says that the first stop holds."""
    n = 3

    def __init__(self, name):
        known = {"thesis_four_bar.toml": FourBar, "toggle_clamp.toml": ToggleClamp}
        if name not in known:
            raise ValueError("no equations are written by hand for this one")
        self.of = known[name]()
        self.held, self.least = self.of.stops[:1], self.of.least[:1]

    def forget(self):
        pass

    def evaluations(self, found, _):
        return found.nfev

    def start_from(self, x):
        self.x = np.array(x)
        y = np.linalg.lstsq(self.held_jacobian(self.x).T, -self.of.gradient(self.x), rcond=None)[0]
        self.xy = np.concatenate([self.x, y])

    def held_jacobian(self, q):
        return np.vstack([self.of.closure_jacobian(q), self.held])

    def balance(self, z):
        q, y = z[:3], z[3:]
        force = self.of.gradient(q) + self.held_jacobian(q).T @ y
        return np.concatenate([force, self.of.closure(q), self.held @ q - self.least])

    def balance_jacobian(self, z):
        q, y = z[:3], z[3:]
        jacobian = self.held_jacobian(q)
        m = len(jacobian)
        hessian = self.of.hessian(q) + self.of.closure_hessian(q, y)
        return np.block([[hessian, jacobian.T], [jacobian, np.zeros((m, m))]])


# Each takes a scene and an accuracy, and returns what solves once: () -> OptimizeResult.

def root(method, by_hand):
    def prepare(scene, accuracy):
        options = {"xtol": accuracy} if method == "hybr" else {"xtol": accuracy, "ftol": accuracy}
        jac = scene.balance_jacobian if by_hand else None
        return lambda: so.root(scene.balance, scene.xy, jac=jac, method=method, options=options)
    return prepare


def slsqp(by_hand):
    def prepare(scene, accuracy):
        of = scene.of
        constraints = [{"type": "eq", "fun": of.closure}]
        if by_hand:
            constraints[0]["jac"] = of.closure_jacobian
        if len(of.stops):
            constraints.append({"type": "ineq", "fun": lambda q: of.stops @ q - of.least, "jac": lambda q: of.stops})
        options = {"ftol": accuracy**2, "maxiter": 1000}  # of the energy, which is flat at rest
        return lambda: so.minimize(of.energy, scene.x, jac=of.gradient if by_hand else None, method="SLSQP",
                                   constraints=constraints, options=options)
    return prepare


def trust_constr(by_hand):
    def prepare(scene, accuracy):
        of = scene.of
        derivatives = {"jac": of.closure_jacobian, "hess": of.closure_hessian} if by_hand else {}
        constraints = [so.NonlinearConstraint(of.closure, 0.0, 0.0, **derivatives)]
        if len(of.stops):
            constraints.append(so.LinearConstraint(of.stops, of.least, np.inf))
        of_energy = {"jac": of.gradient, "hess": of.hessian} if by_hand else {}
        options = {"gtol": accuracy, "xtol": accuracy, "barrier_tol": accuracy, "maxiter": 300}
        return lambda: so.minimize(of.energy, scene.x, method="trust-constr", constraints=constraints,
                                   options=options, **of_energy)
    return prepare


METHODS = {
    "root hybr": root("hybr", True), "root hybr, differences": root("hybr", False),
    "root lm": root("lm", True), "root lm, differences": root("lm", False),
    "SLSQP": slsqp(True), "SLSQP, differences": slsqp(False),
    "trust-constr": trust_constr(True), "trust-constr, differences": trust_constr(False)}

if __name__ == "__main__":
    scipy_baseline.serve(Scene, METHODS)
