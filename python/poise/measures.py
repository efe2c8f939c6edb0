"""Measures of a pose by the names of what they are between, for poise.SceneBuilder (docs/scene-files.md#measures).

>>> from poise import measures
>>> lift = measures.sum([(2, measures.travel("guide")), (1, measures.x("arm.B"))])
"""

from __future__ import annotations

from typing import Callable, Iterable, SupportsFloat

from . import _poise
from ._poise import Measure
from ._tables import refuse_mask

__all__ = ["Measure", "angle", "distance", "nothing", "sum", "travel", "x", "y"]


def _made(kind: str, maker: Callable[..., Measure], *given: object) -> Measure:
    refuse_mask(kind, given)
    try:
        return maker(*given)
    except (TypeError, UnicodeEncodeError):
        raise _poise.InputError(f"{kind}: expected what help(poise.measures.{kind}) names, "
                                f"found {', '.join(repr(one) for one in given):.200}") from None


def angle(body_a: str, body_b: str) -> Measure:
    """angle(body_b) - angle(body_a), counter-clockwise positive, not wrapped; one of them may be "ground"."""
    return _made("angle", Measure.angle, body_a, body_b)


def distance(a: str, b: str) -> Measure:
    """Distance of two points "BODY.POINT" of different bodies."""
    return _made("distance", Measure.distance, a, b)


def travel(joint: str) -> Measure:
    """Travel of a slide or pin in a slot: signed distance from its first point to its second along its axis."""
    return _made("travel", Measure.travel, joint)


def x(point: str) -> Measure:
    """World coordinate x of a point "BODY.POINT"."""
    return _made("x", Measure.x, point)


def y(point: str) -> Measure:
    """World coordinate y of a point "BODY.POINT"."""
    return _made("y", Measure.y, point)


def sum(terms: Iterable[tuple[SupportsFloat, Measure]]) -> Measure:
    """Sum of factor times measure, over pairs (factor, measure)."""
    return _made("sum", Measure.sum, terms)


def nothing() -> Measure:
    """No measure: of a controller that acts on nothing."""
    return _made("nothing", Measure.nothing)
