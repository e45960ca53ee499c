"""The arrays of the kernels that follow a contact: tableau, contact, equations, terms of the work, queue of changes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Tableau(NamedTuple):
    """A matrix, its updates, and the rates of the dependent variables. There are n nodes and m motions of the pin.

    Attributes
    ----------
    matrix : ndarray, shape (2n+m, 2n), column by column
    fresh : ndarray of int, shape (blocks,)
        Number of updates that each block of columns contains; -1 if the block was never computed.
    left : ndarray, shape (2n+m, room), column by column
        The vector of each update.
    source, slot : ndarray of int, shape (room,)
    delta : ndarray, shape (room,)
        The three numbers of each update.
    factors : ndarray, shape (4,)
        Memory for the factors of four updates of a column.
    rates : ndarray, shape (2n+m,)
        Rates of the dependent variables and of the pin's motion, per unit of the step.
    order : ndarray of int, shape (2n+m,)
        Where ``matrix`` is the table of a held contact: the place of each dependent variable in its rows, and of each
        zero-rate variable in its columns. Its rows hold T instead of tau. Empty if rows and columns are in order.
    tied : ndarray, shape (n,)
        With ``order``: the factor tie mu of sticking nodes, 0 elsewhere.
    drag : ndarray, shape (n,)
        With ``order``: the shear that comes with a unit of N at open nodes, 0 elsewhere.
    chunk : int
        Number of updates after which a block must be brought up to date before a column of it is used.
    width : int
        Number of columns in a block.
    """

    matrix: np.ndarray
    fresh: np.ndarray
    left: np.ndarray
    source: np.ndarray
    slot: np.ndarray
    delta: np.ndarray
    factors: np.ndarray
    rates: np.ndarray
    order: np.ndarray
    tied: np.ndarray
    drag: np.ndarray
    chunk: int
    width: int


class PortTables(NamedTuple):
    """The tables of S interfaces with ports: k nodes, p outputs and q inputs each; see :mod:`fastpin.joints.ports`.

    There are g motions and harmonics, and m motions.

    Attributes
    ----------
    rows : ndarray of int, shape (S, 2k)
        Rows of each interface among (N, T) of all nodes.
    place : ndarray of int, shape (2n,)
        The place of each row of all nodes among the rows of the interfaces.
    inputs : ndarray of int, shape (S, q)
        Places of the inputs among the motions and harmonics.
    tables : ndarray, shape (S, 2k+q, 2k+p)
        Map zero-rate variables and inputs to dependent variables and outputs, transposed.
    answers : ndarray, shape (g, S p + m)
        Map outputs with the opposite sign, and forces, to the motions and harmonics.
    left, right : ndarray, shape (room, g), (room, S p + m)
        Changes of the answers that wait: each adds the product of its two vectors.
    coupling : ndarray, shape (n,)
        Shear per pressure of each tie.
    latest : ndarray, shape (g,)
        What the column moves that was computed last, with the opposite sign.
    counts : ndarray of int, shape (3,)
        See :mod:`fastpin.kernels.ports`.
    """

    rows: np.ndarray
    place: np.ndarray
    inputs: np.ndarray
    tables: np.ndarray
    answers: np.ndarray
    left: np.ndarray
    right: np.ndarray
    coupling: np.ndarray
    latest: np.ndarray
    counts: np.ndarray


class Contact(NamedTuple):
    """The contact that evolves along a step. Arrays have shape (n,), except ``motion`` (m,) and ``slip_tally``.

    ``touched`` says whether a node was ever closed. :mod:`fastpin.kernels.exchange` defines ``tie``. ``slip_tally``
    has slip distance, friction energy, lowest and highest slip of each node while closed, shape (4, n). The extremes
    count from ``rest_slip``. Runs with wear have pressure times slip distance below, shape (5, n). It is empty if
    nothing is counted.
    """

    pressure: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    status: np.ndarray
    tie: np.ndarray
    touched: np.ndarray
    motion: np.ndarray
    rest_slip: np.ndarray
    slip_tally: np.ndarray


class ContactValues(NamedTuple):
    """Pressure, shear, gap, slip and status of each node, shape (n,), and the motion (m,): a contact or a solution."""

    pressure: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    status: np.ndarray
    motion: np.ndarray


class Equations(NamedTuple):
    """The part of the equations that all operators share.

    Attributes
    ----------
    motion : ndarray, shape (2n, m)
        Maps the motion to gap and slip.
    equilibrium : ndarray, shape (m, 2n)
        Maps (N, T) to the conditions of equilibrium.
    motion_rows : ndarray, shape (m, m)
        Maps the motion to the conditions of equilibrium.
    friction : ndarray, shape (n,)
        Coefficient of friction at each node.
    loads : ndarray, shape (2n, loads)
        Maps the loads to gap and slip. A load vector may be longer: its further loads do nothing here.
    work : ndarray, shape (2n, loads)
        Maps the loads to gap and slip without the prescribed displacements, times the weights of the nodes.
    forces : ndarray, shape (m, loads)
        Maps the loads to the right sides of equilibrium.
    """

    motion: np.ndarray
    equilibrium: np.ndarray
    motion_rows: np.ndarray
    friction: np.ndarray
    loads: np.ndarray
    work: np.ndarray
    forces: np.ndarray


class LoadTerms(NamedTuple):
    """Terms of the work of the loads.

    Attributes
    ----------
    column : ndarray, shape (2n,)
        Weights of the traction rates at the beginning of the step.
    column_rate : ndarray, shape (2n,)
        Growth of ``column`` along the step.
    force : ndarray, shape (2,)
        Force (Q, -P) at the beginning of the step.
    force_rate : ndarray, shape (2,)
        Growth of ``force`` along the step.
    weights : ndarray, shape (n,)
        Weights of the nodes.
    levers : ndarray, shape (n,)
        Moment of a unit of shear at each node: its weight times the radius of its rim.
    stops : ndarray of int, shape (interfaces,)
        The place after the last node of each interface.
    reactions : ndarray, shape (2, 2n+3)
        Along x and y: weights of the traction rates per reaction, growth of the prescribed displacement, compliance g,
        and 1 if a displacement is prescribed. The motion then holds the reaction.
    """

    column: np.ndarray
    column_rate: np.ndarray
    force: np.ndarray
    force_rate: np.ndarray
    weights: np.ndarray
    levers: np.ndarray
    stops: np.ndarray
    reactions: np.ndarray


class Queue(NamedTuple):
    """Waiting changes of status, shape (2n,), and the counters and sums of a step.

    Their slots stand in :mod:`fastpin.kernels.exchange`.
    """

    node: np.ndarray
    status: np.ndarray
    counts: np.ndarray
    sums: np.ndarray
