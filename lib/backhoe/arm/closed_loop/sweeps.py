"""A batch in chunks: on this machine with a progress bar, or on a cluster, through `joblib`."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.closed_loop.batch import Batch, joined
from backhoe.arm.closed_loop.runs import simulate
from backhoe.arm.closed_loop.task import Task
from backhoe.arm.movement import Movement
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import whole
from backhoe.basics.progress import progress_bar

RUNS_IN_A_CHUNK = 32


def sweep(
    gains: Gains,
    movement: Movement,
    *,
    chunks: int | None = None,
    backend: str | None = None,
    progress: bool = True,
    **options: object,
) -> Batch:
    """`simulate` in chunks, with the same numbers to the last bit.

    Left alone, it goes through the chunks one by one, each on all cores. Inside
    `with joblib.parallel_config(backend="dask"):`, or another backend, each chunk is one task of
    one thread there: start as many workers as there are cores.

    Args:
        gains: of shape (n, 4) each [N m/rad, N m/(rad s), N m s/rad].
        movement: as for `simulate`.
        chunks: in how many pieces; one for every 32 runs unless told.
        backend: a backend of joblib, such as "loky" or "threading", on all its workers; None for
            what `joblib.parallel_config` says.
        progress: whether to show a bar while it runs; it leaves nothing behind.
        options: as for `simulate`, but for threads.

    Returns:
        What `simulate` returns.

    Raises:
        ValueError: chunks is not a whole number from 1 to n, and as for `simulate`.
        TypeError: as for `simulate`, or an unknown option.
    """
    import joblib

    task = Task(gains, movement, **options)
    count = len(task)
    pieces = _pieces(chunks, count)
    parallel = joblib.Parallel(
        n_jobs=None if backend is None else -1, backend=backend, return_as="generator"
    )
    alone = backend is None and joblib.effective_n_jobs() == 1
    t, motion = movement.t, np.stack([movement.q, movement.dq, movement.ddq])
    chunk, threads = joblib.delayed(_chunk), None if alone else 1
    done = parallel(chunk(t, motion, threads, task.part(*piece)) for piece in pieces)
    batches = []
    with progress_bar(count, "simulations", progress) as advance:
        for batch in done:
            batches.append(batch)
            advance(len(batch))
    return joined(batches)


def _chunk(t: NDArray, motion: NDArray, threads: int | None, options: dict) -> Batch:
    """One task. The reference comes as arrays, which joblib hands to each worker only once."""
    return simulate(movement=Movement(t, *motion), threads=threads, **options)


def _pieces(chunks: int | None, count: int) -> list[tuple[int, int]]:
    """First run and end of each chunk."""
    if chunks is None:
        chunks = -(-count // RUNS_IN_A_CHUNK)
    whole(chunks, "chunks", least=1, most=count)
    edges = np.linspace(0, count, chunks + 1).round().astype(int).tolist()
    return list(pairwise(edges))
