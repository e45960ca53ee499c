"""The smallest sphere round points, exact: it is determined by a few of them, its support.

The support grows by the farthest point outside. Then all subsets of the support are tried: the centre of the smallest
sphere lies at the same distance from all points of some subset, and in its span. The radius grows with every step, so
the search ends. Welzl (1991) gives the theory; Gaertner (1999) the rule of the farthest point.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.runtime.jit import compiled, inner

ROUNDING = 1e-13
"""Growth of a radius that is rounding, in parts of the radius."""

FLAT = 1e-15
"""Least pivot of points that determine a sphere, in parts of the largest squared distance between them."""

STEPS = 1000
"""Most steps of the search."""


@inner
def _centre(points, chosen, size, matrix, centre):
    """Fill the centre of the smallest sphere through `size` chosen points; False if they have no such sphere."""
    dimension, first = points.shape[1], chosen[0]
    rank, largest = size - 1, 0.0
    for i in range(rank):
        for j in range(rank):
            matrix[i, j] = 0.0
            for k in range(dimension):
                one = points[chosen[i + 1], k] - points[first, k]
                other = points[chosen[j + 1], k] - points[first, k]
                matrix[i, j] += 2.0 * one * other
        matrix[i, rank] = 0.5 * matrix[i, i]
        largest = max(largest, matrix[i, i])
    for i in range(rank):
        pivot = i
        for j in range(i + 1, rank):
            if abs(matrix[j, i]) > abs(matrix[pivot, i]):
                pivot = j
        if abs(matrix[pivot, i]) <= FLAT * largest:
            return False
        for k in range(rank + 1):
            matrix[i, k], matrix[pivot, k] = matrix[pivot, k], matrix[i, k]
        for j in range(i + 1, rank):
            part = matrix[j, i] / matrix[i, i]
            for k in range(i, rank + 1):
                matrix[j, k] -= part * matrix[i, k]
    for i in range(rank - 1, -1, -1):
        for j in range(i + 1, rank):
            matrix[i, rank] -= matrix[i, j] * matrix[j, rank]
        matrix[i, rank] /= matrix[i, i]
    for k in range(dimension):
        centre[k] = points[first, k]
        for i in range(rank):
            centre[k] += matrix[i, rank] * (points[chosen[i + 1], k] - points[first, k])
    return True


@inner
def _distance(points, i, centre):
    """Distance of a point from the centre."""
    square = 0.0
    for k in range(points.shape[1]):
        square += (points[i, k] - centre[k]) ** 2
    return math.sqrt(square)


@inner
def _smallest(points, support, size, chosen, matrix, centre, best):
    """Fill the centre `best` of the smallest sphere round a support; returns the points that determine it, as bits."""
    radius, bits = np.inf, 0
    for subset in range(1, 1 << size):
        count = 0
        for k in range(size):
            if subset >> k & 1:
                chosen[count] = support[k]
                count += 1
        if count > points.shape[1] + 1 or not _centre(points, chosen, count, matrix, centre):
            continue
        farthest = 0.0
        for k in range(size):
            farthest = max(farthest, _distance(points, support[k], centre))
        if farthest < radius:
            radius, bits = farthest, subset
            for k in range(points.shape[1]):
                best[k] = centre[k]
    return bits


@compiled
def enclosing_spheres(paths, out):
    """Find the smallest sphere round the path of each point.

    Parameters
    ----------
    paths : ndarray, shape (points, times, dimension)
    out : ndarray, shape (points, dimension + 1)
        Centre and radius.
    """
    dimension = paths.shape[2]
    support, chosen = np.empty(dimension + 2, dtype=np.int64), np.empty(dimension + 2, dtype=np.int64)
    matrix = np.empty((dimension + 2, dimension + 3))
    trial, centre = np.empty(dimension), np.empty(dimension)
    for i in range(paths.shape[0]):
        path, size, radius = paths[i], 1, -1.0
        support[0], centre[:] = 0, paths[i, 0]
        for _ in range(STEPS):
            farthest, place = 0.0, 0
            for t in range(path.shape[0]):
                distance = _distance(path, t, centre)
                if distance > farthest:
                    farthest, place = distance, t
            inside = 0.0
            for k in range(size):
                inside = max(inside, _distance(path, support[k], centre))
            if radius < 0.0 or farthest < radius:
                radius = farthest
                out[i, :dimension], out[i, dimension] = centre, farthest
            if farthest <= inside * (1.0 + ROUNDING):
                break
            support[size] = place
            size += 1
            bits = _smallest(path, support, size, chosen, matrix, trial, centre)
            kept = 0
            for k in range(size):
                if bits >> k & 1:
                    support[kept] = support[k]
                    kept += 1
            size = kept
