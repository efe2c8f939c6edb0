"""The equations of equilibrium of a scene, for solvers and programs of others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Iterable, Mapping

from . import _poise
from ._tables import refuse_mask

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from ._poise import Certificate, System

    Array = npt.NDArray[np.float64]


class Equations:
    """What a scene offers to SciPy, CasADi, JAX and programs of your own: its equations, their derivatives, its proofs.

    x are the n coordinates of the scene, in rad and in its unit of length. A root finder on `equations` and `jacobian`
    reaches an equilibrium, and `certify` says what is proved of it:

    >>> import numpy as np, scipy.optimize, poise
    >>> arm = poise.load("datasets/four_bar_torsion.toml")
    >>> found = scipy.optimize.root(arm.equations, arm.start(), jac=arm.jacobian)
    >>> bool(found.success), arm.certify(found.x).stability
    (True, 'stable')
    """

    __slots__ = ()

    _core: _poise.Scene

    @property
    def coordinates(self) -> list[tuple[str, str]]:
        """Name and unit of each of the n coordinates x: the body whose absolute angle it is (``rad``), the joint whose
        travel, or ``"BODY.x"`` of a body that no joint ties to the ground (the scene's unit of length).

        What no load, spring or loop depends on is no coordinate.
        """
        return _poise.coordinates(self._core)

    def start(self) -> Array:
        """x where the mechanism is assembled from its start, shape (n,). InputError where it cannot be."""
        return _poise.system(self._core, None).start

    def system(self, touching: Mapping[str, str] | Iterable[str] | None = None) -> System:
        """The equations in full, as a `System`: energy V and its gradient F, closures c, their derivatives,
        multipliers, stops, and all of these where limits of stops hold.

        ``touching`` names the stops that are touched, ``["over_centre"]``, or, of a stop with two limits, which one:
        ``{"over_centre": "min"}``, as ``Certificate.touching`` has them. Their limits are rows of c then.
        """
        return _poise.system(self._core, touching)

    def equations(self, x: npt.ArrayLike, out: Array | None = None) -> Array:
        """n values that are zero in equilibrium, shape (n,), with all stops free.

        ``(N^T F; c)``: virtual work ``N^T F = F_v + J_v^T y``, ``y = -J_u^-T F_u``, along the n - m independent
        directions N, then the m independent closures c, with ``F = dV/dx`` and ``J = dc/dx`` (see `System`). Work is in
        force times length of the scene along angles, in force along lengths; c is in rad or length. Filled into
        ``out`` if given. InputError for an x of another shape, or not finite.
        """
        refuse_mask("x", x)
        return _poise.system(self._core, None).equations(x, None, out)

    def jacobian(self, x: npt.ArrayLike, out: Array | None = None) -> Array:
        """The derivative of `equations`, ``(N^T K(x, y); J)``, ``K = dF/dx + sum_r y_r d2c_r/dx2``; shape (n, n)."""
        refuse_mask("x", x)
        return _poise.system(self._core, None).jacobian(x, None, out)

    def hessian(self, x: npt.ArrayLike, multipliers: npt.ArrayLike | None = None, out: Array | None = None) -> Array:
        """dF/dx, the Hessian of the energy V where loads have one; shape (n, n).

        With ``multipliers`` y, shape (m,), that of the Lagrangian: ``K = dF/dx + sum_r y_r d2c_r/dx2``.
        """
        refuse_mask("x", x)
        refuse_mask("multipliers", multipliers)
        return _poise.system(self._core, None).hessian(x, multipliers, out)

    def certify(self, x: npt.ArrayLike, farthest: float = 1e-3, proof_seconds: float | None = None) -> Certificate:
        """Examine x, from whatever solver, and prove an equilibrium near it, or say why not (docs/certificate.md).

        ``farthest`` is how far the equilibrium may be from x, in rad or mechanism sizes; ``proof_seconds`` the time
        allowed. Of the `Certificate`, ``proved`` is True or False, ``statement`` one sentence; where it is proved,
        ``x`` is the refined place, ``radius`` (rad or mechanism sizes) and ``radii`` (in the units of x, shape (n,))
        how close to it the equilibrium is, ``stability`` and ``unstable_directions`` what it is, ``touching`` the stops
        that it presses on. Stops count: where one must act the equilibrium with that one is proved.
        """
        refuse_mask("x", x)
        return _poise.certify(self._core, x, farthest, proof_seconds)
