"""Ridges between rows of a round or a pointed tool that are narrower than a cell, which the columns do not show.

Columns are exact at their centres. Between rows p apart a tool of radius R leaves ridges p^2 / (8 R) high, one whose
flanks rise by c leaves ridges c p / 2 high. Where p is less than two cells, and cells and rows meet again after a few
of them, all columns of a wide region stand at the same place of a row, or at places that change slowly: in the troughs,
on the ridges, on flanks. Their heights tell of no wave (`wave_kernels`), and each may be off by a third of a ridge
downwards to two thirds upwards, or by half of a pointed one.

So a stock remembers, in patches of its columns, how much way such tools have cut with which radius or rise. Where a
patch has rows closer than `CLOSE` cells on the average, columns that hardly differ from their neighbours, by less than
the ridge is high, count with two thirds of it. A single trough bends by h^2 / R from column to column, or by c h, which
is more than that. What an earlier run has left counts where this one takes it away. Rows may have been cut twice, or in
several levels; so p is taken to be up to `DOUBLE` times what the way says, at most `WIDEST` cells: wider rows are seen.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import PATCH, PATCH_SHIFT, Field, Grid

Array = NDArray[np.float64]

WAY, BEND, LOW, RISE = 0, 1, 2, 3  # of a patch: way [m] that has cut, greatest 1/R [1/m], lowest tip [m], greatest c
RIDGE_PLANES = 4

CLOSE = 2.3  # cells from row to row, up to which rows are looked at
WIDEST = 1.15  # cells
DOUBLE = 1.5
SHALLOW = 0.5  # of a ridge: columns that differ less from their neighbours may all stand at one place of their rows
RIDGE = 2.0 / 3.0  # of its height
ALONG = 4.0  # parts of the way in a patch, each of which counts for one patch


@kernel
def note_way(grid: Grid, starts: Array, ends: Array, took: Array, bend: float, rise: float, ridges: Array) -> None:
    """Add straight pieces (c, 3) [m] that took material (c,) to `ridges` (RIDGE_PLANES, …) of the patches below them.

    bend: 1/R of the tool's edge [1/m]; rise: that of its flanks [-].
    """
    wide = PATCH * min(grid.dx, grid.dy)
    for k in range(starts.shape[0]):
        if took[k] <= 0.0:
            continue
        dx, dy, dz = ends[k, 0] - starts[k, 0], ends[k, 1] - starts[k, 1], ends[k, 2] - starts[k, 2]
        way = math.sqrt(dx * dx + dy * dy)
        parts = math.ceil(ALONG * way / wide)
        for part in range(parts):
            s = (part + 0.5) / parts
            i = math.floor((starts[k, 0] + s * dx - grid.x) / (grid.dx * PATCH))
            j = math.floor((starts[k, 1] + s * dy - grid.y) / (grid.dy * PATCH))
            if i < 0 or j < 0 or i >= ridges.shape[1] or j >= ridges.shape[2]:
                continue
            low = starts[k, 2] + s * dz
            ridges[LOW, i, j] = low if ridges[WAY, i, j] == 0.0 else min(ridges[LOW, i, j], low)
            ridges[WAY, i, j] += way / parts
            ridges[BEND, i, j] = max(ridges[BEND, i, j], bend)
            ridges[RISE, i, j] = max(ridges[RISE, i, j], rise)


@kernel
def row_distance(change: Array, way: float, cell: float, pi: int, pj: int) -> float:
    """How far [m] rows are apart on the average where a patch of columns was cut along `way` [m]."""
    cut = 0
    for i in range(pi << PATCH_SHIFT, min((pi + 1) << PATCH_SHIFT, change.shape[0])):
        for j in range(pj << PATCH_SHIFT, min((pj + 1) << PATCH_SHIFT, change.shape[1])):
            if change[i, j] > 0.0:
                cut += 1
    return float(cut * cell * cell / way)


@kernel
def bend_at(field: Field, change: Array, i: int, j: int) -> float:
    """By how much [m] the top of a column is off the middle of its neighbours in x and in y, one added to the other.

    A column at a border counts as the one beside it. Negative where this cannot be said: beside walls and columns that
    were not cut.
    """
    nx, ny = change.shape
    if nx < 3 or ny < 3:
        return -1.0
    i, j = min(max(i, 1), nx - 2), min(max(j, 1), ny - 2)
    if field.columns.number[i, j] == 0 or change[i, j] == 0.0:
        return -1.0
    top = field.columns.hi[i, j, field.columns.number[i, j] - 1]
    off = 0.0
    for axis in range(2):
        for side in range(2):
            a, b = (i + side, j) if axis == 0 else (i, j + side)
            if field.walls[axis, a, b] != 0.0:
                return -1.0
        ends = 0.0
        for side in range(-1, 2, 2):
            a, b = (i + side, j) if axis == 0 else (i, j + side)
            if field.columns.number[a, b] == 0 or change[a, b] == 0.0:
                return -1.0
            ends += field.columns.hi[a, b, field.columns.number[a, b] - 1]
        off += abs(ends - 2.0 * top)
    return off


@kernel
def steepness(field: Field, i: int, j: int) -> float:
    """Square of the slope of the tops around a column; at a border, around the one beside it."""
    columns, square = field.columns, 0.0
    i, j = min(max(i, 1), columns.number.shape[0] - 2), min(max(j, 1), columns.number.shape[1] - 2)
    for axis in range(2):
        a, b = (1, 0) if axis == 0 else (0, 1)
        rise = columns.hi[i + a, j + b, columns.number[i + a, j + b] - 1]
        rise -= columns.hi[i - a, j - b, columns.number[i - a, j - b] - 1]
        slope = rise / (2.0 * (field.grid.dx if axis == 0 else field.grid.dy))
        square += slope * slope
    return float(square)


@kernel
def ridge_error(field: Field, change: Array, cut: Array, ridges: Array) -> float:
    """Volume [m^3] by which changed material with ridges that the columns do not show may be off.

    `cut` (nx, ny) is not 0 where the tools of the ridges took something.
    """
    cell = math.sqrt(field.grid.dx * field.grid.dy)
    total = 0.0
    for pi in range(ridges.shape[1]):
        for pj in range(ridges.shape[2]):
            way, bend, low, rise = ridges[WAY, pi, pj], ridges[BEND, pi, pj], ridges[LOW, pi, pj], ridges[RISE, pi, pj]
            if way <= 0.0:
                continue
            apart = row_distance(cut, way, cell, pi, pj)
            if apart > CLOSE * cell:
                continue
            wide = min(DOUBLE * apart, WIDEST * cell)
            for i in range(pi << PATCH_SHIFT, min((pi + 1) << PATCH_SHIFT, change.shape[0])):
                for j in range(pj << PATCH_SHIFT, min((pj + 1) << PATCH_SHIFT, change.shape[1])):
                    off = bend_at(field, change, i, j)
                    if off < 0.0:
                        continue
                    square = steepness(field, i, j)
                    lean = 1.0 + square
                    high = max(0.125 * bend * wide * wide * lean * math.sqrt(lean), 0.5 * rise * wide)
                    if off > SHALLOW * high:
                        continue
                    top = field.columns.hi[i, j, field.columns.number[i, j] - 1]
                    if off == 0.0 and square == 0.0 and not low - high <= top <= low + high:
                        continue  # a floor of another tool
                    total += RIDGE * high
    return float(total * field.grid.dx * field.grid.dy)
