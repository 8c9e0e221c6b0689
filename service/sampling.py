"""Monte Carlo runs on the device: cells in, exact counts and sums of powers of the weight out.

The unit of work is a block, a fixed range of samples of one cell. Blocks are drawn in launches of bounded size, whose
sums are added in block order in double precision: the result does not depend on launch size, threads, or other cells.
"""

from __future__ import annotations

import itertools
import math
import struct
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from lavapipe import Buffer, Device, Pipeline, Submission
from service.errors import SamplerscopeError
from service.random_numbers import BLOCK_SAMPLES

LANES = 64
PILOT_SAMPLES = 4 * LANES
LAUNCH_BLOCKS = 1024  # at most, 17 M samples: 0.02 to 0.2 s, so that progress and cancelling are prompt
SHORT_LAUNCH_BLOCKS = 256  # of a run that has fewer than four long ones
LEAST_OUTPUT_BLOCKS = 16
LAUNCHES_IN_FLIGHT = 2  # the host adds one launch while the device draws the next
TIMEOUT_S = 600.0
NO_INDEX = 0xFFFFFFFF
LARGEST, NOT_POSITIVE, FIRST_BAD, DRAWN = range(4)  # what `found` of shaders/statistics.comp holds


class IncompleteRun(SamplerscopeError):
    """The device drew fewer samples than asked: the driver ended a loop, and the result would be wrong."""


@dataclass(frozen=True)
class Cells:
    """Views and parameters to draw for: wo (n, 3) and parameters (n, p) as float32, or as float64 for a run in double
    precision; keys (n, 2) of random numbers.
    """

    wo: NDArray[np.floating[Any]]
    keys: NDArray[np.uint32]
    parameters: NDArray[np.floating[Any]]

    def __len__(self) -> int:
        return len(self.wo)


@dataclass
class CellSums:
    """What a run found, an entry a cell. `first_bad` is the index of the first non-finite sample, -1 where there is
    none.
    """

    drawn: NDArray[np.int64]
    zero: NDArray[np.int64]
    nonfinite: NDArray[np.int64]
    negative: NDArray[np.int64]
    first_bad: NDArray[np.int64]
    shift: NDArray[np.float64]
    powers: NDArray[np.float64]
    largest: NDArray[np.float64]
    device_ns: int = 0

    @property
    def counted(self) -> NDArray[np.int64]:
        """Samples that the sums hold: all but the non-finite ones."""
        return self.drawn - self.nonfinite


@dataclass(frozen=True)
class Checkpoint:
    """A run after its first `launches` launches: what they found. A run that starts from it ends with the same bits."""

    launches: int
    sums: CellSums


class Journal(Protocol):
    """Where the runs of one series, which come in a fixed order, keep how far they are."""

    def begin(self) -> Checkpoint | None:
        """Called by each run at its start: its last checkpoint, or None where it is new."""

    def save(self, checkpoint: Checkpoint) -> None:
        """Called after every launch. The sums change when this has returned. May raise, which ends the run."""


@dataclass(frozen=True)
class _Launch:
    first_cell: int
    cells: int
    first_block: int
    blocks: int


class Sampler:
    """A pipeline with its buffers, ready to draw for up to `len(cells)` cells. Close it, or use it as a context
    manager.
    """

    def __init__(self, device: Device, pipeline: Pipeline, cells: Cells) -> None:
        self._device = device
        self._pipeline = pipeline
        self._count = len(cells)
        self._cells = device.buffer((len(cells),), CELL)
        fill_cells(self._cells.array, cells)
        self._parameters = device.buffer((max(1, cells.parameters.size),), np.float32)
        self._parameters.array[: cells.parameters.size] = cells.parameters.ravel()
        self._outputs: list[tuple[Buffer, Buffer] | None] = [None] * LAUNCHES_IN_FLIGHT

    def __enter__(self) -> Sampler:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Free the buffers."""
        for buffer in itertools.chain.from_iterable(filter(None, self._outputs)):
            buffer.close()
        self._parameters.close()
        self._cells.close()

    def warm_up(self) -> None:
        """Draw once, so that the driver compiles before anything is timed."""
        launch = _Launch(0, 1, 0, 1)
        self._submit(launch, 1, self._outputs_for(launch)).wait(TIMEOUT_S)

    def launch(self, blocks: int) -> int:
        """Draw so many blocks of every cell in one launch and add nothing; the device's nanoseconds."""
        cells = min(self._count, LAUNCH_BLOCKS)
        launch = _Launch(0, cells, 0, min(blocks, LAUNCH_BLOCKS // cells))
        return self._submit(launch, blocks * BLOCK_SAMPLES, self._outputs_for(launch)).wait(TIMEOUT_S).total_ns

    def run(
        self, samples: int, progress: Callable[[int], None] = lambda done: None, journal: Journal | None = None
    ) -> CellSums:
        """Draw `samples` samples for every cell. `progress` is called with the number just finished.

        With a `journal` the run goes on from its checkpoint. Both may raise, which ends the run.
        """
        start = journal.begin() if journal is not None else None
        if start is None:
            start = Checkpoint(0, _empty_sums(self._pilot(min(samples, PILOT_SAMPLES))))
        else:
            progress(int(start.sums.drawn.sum()))
        self._cells.array["shift"] = start.sums.shift
        self._extend(start, 0, samples, progress, journal)
        return _complete(start.sums, samples)

    def run_prefixes(
        self, counts: Sequence[int], progress: Callable[[int], None] = lambda done: None
    ) -> list[CellSums]:
        """What `run` gives for each of these increasing counts, drawing no block twice where a count ends with one."""
        shift = self._pilot(min(counts[-1], PILOT_SAMPLES))
        self._cells.array["shift"] = shift
        found: list[CellSums] = []
        total, drawn = _empty_sums(shift), 0
        for count in counts:
            if drawn % BLOCK_SAMPLES:
                total, drawn = _empty_sums(shift), 0
            self._extend(Checkpoint(0, total), drawn // BLOCK_SAMPLES, count, progress, None)
            drawn = count
            found.append(deepcopy(_complete(total, count)))
        return found

    def _extend(
        self,
        start: Checkpoint,
        first_block: int,
        samples: int,
        progress: Callable[[int], None],
        journal: Journal | None,
    ) -> None:
        """Add the blocks from `first_block` on, up to `samples` samples in all, but those of launches done already."""
        added = start.launches
        pending: deque[tuple[_Launch, Submission, tuple[Buffer, Buffer]]] = deque()

        def add_oldest() -> None:
            nonlocal added
            drawn = _add(start.sums, *pending.popleft())
            added += 1
            if journal is not None:
                journal.save(Checkpoint(added, start.sums))
            progress(drawn)

        try:
            for number, launch in enumerate(_launches(self._count, first_block, samples)):
                if number < start.launches:
                    continue
                if len(pending) == LAUNCHES_IN_FLIGHT:
                    add_oldest()
                outputs = self._outputs_for(launch, number % LAUNCHES_IN_FLIGHT)
                pending.append((launch, self._submit(launch, samples, outputs), outputs))
            while pending:
                add_oldest()
        finally:
            for _, submission, _ in pending:
                submission.close()

    def _pilot(self, samples: int) -> NDArray[np.float64]:
        """The shift of every cell's power sums: the median over lanes of the mean of a lane's first weights."""
        self._cells.array["shift"] = 0.0
        shifts = np.empty(self._count)
        for first in range(0, self._count, LAUNCH_BLOCKS):
            launch = _Launch(first, min(LAUNCH_BLOCKS, self._count - first), 0, 1)
            outputs = self._outputs_for(launch)
            self._submit(launch, samples, outputs, timed=False).wait(TIMEOUT_S)
            powers, found = (_view(buffer, launch)[:, :, 0] for buffer in outputs)
            used = found[:, 0, DRAWN] != 0
            if not used.any():
                raise IncompleteRun(f"the driver ended a loop after 0 of {samples} samples")
            means = np.sort(powers[used, :, 0] / (found[used, :, DRAWN] & 0xFFFF), axis=0)
            shifts[first : first + launch.cells] = (means[(len(means) - 1) // 2] + means[len(means) // 2]) / 2
        return shifts.astype(np.float32).astype(np.float64)

    def _submit(
        self, launch: _Launch, samples: int, outputs: tuple[Buffer, Buffer], *, timed: bool = True
    ) -> Submission:
        last_block, before = (samples - 1) // BLOCK_SAMPLES, (samples - 1) // BLOCK_SAMPLES * BLOCK_SAMPLES
        constants = struct.pack("<4I", launch.first_cell, launch.first_block, last_block, samples - before)
        commands = self._device.record()
        commands.dispatch(
            self._pipeline,
            [self._cells, self._parameters, *outputs],
            (launch.blocks, launch.cells, 1),
            push_constants=constants,
        )
        return commands.submit(timed=timed)

    def _outputs_for(self, launch: _Launch, slot: int = 0) -> tuple[Buffer, Buffer]:
        """Where a launch writes. Buffers are as large as the largest launch so far, since zeroing them costs time."""
        words = 4 * LANES * max(LEAST_OUTPUT_BLOCKS, launch.cells * launch.blocks)
        pair = self._outputs[slot]
        if pair is None or pair[0].shape[0] < words:
            for buffer in pair or ():
                buffer.close()
            pair = self._device.buffer((words,), np.float32), self._device.buffer((words,), np.uint32)
            self._outputs[slot] = pair
        return pair


CELL = np.dtype([("wo", "<f4", 3), ("shift", "<f4"), ("key", "<u4", 2), ("padding", "<u4", 2)])
"""A cell as the shaders see it."""


def fill_cells(table: NDArray[Any], cells: Cells) -> None:
    """Write the cells into an array of CELL whose shifts are 0."""
    table["wo"] = cells.wo
    table["key"] = cells.keys


def _launches(cells: int, start: int, samples: int) -> Iterator[_Launch]:
    """The launches of a run, at least four where it is not short: a function of the run, so that it can be resumed."""
    blocks = -(-samples // BLOCK_SAMPLES)
    most = min(LAUNCH_BLOCKS, max(SHORT_LAUNCH_BLOCKS, cells * (blocks - start) // 4))
    for first_cell in range(0, cells, most):
        count = min(most, cells - first_cell)
        step = most // count
        for first_block in range(start, blocks, step):
            yield _Launch(first_cell, count, first_block, min(step, blocks - first_block))


def _view(buffer: Buffer, launch: _Launch) -> NDArray[Any]:
    """The outputs of a launch as (lane, cell, block, four numbers)."""
    shape = (LANES, launch.cells, launch.blocks, 4)
    return buffer.array[: math.prod(shape)].reshape(shape)


def _add(total: CellSums, launch: _Launch, submission: Submission, outputs: tuple[Buffer, Buffer]) -> int:
    """Wait for a launch and add its sums, block after block; the number of samples drawn."""
    total.device_ns += submission.wait(TIMEOUT_S).total_ns
    cells = slice(launch.first_cell, launch.first_cell + launch.cells)
    powers, found = (_view(buffer, launch) for buffer in outputs)
    blocks = powers.astype(np.float64).sum(axis=0)
    for block in range(launch.blocks):
        total.powers[:, cells] += blocks[:, block].T
    largest = found.view(np.float32).max(axis=0)[..., LARGEST].max(axis=1)
    np.maximum(total.largest[cells], largest, out=total.largest[cells])
    counts = found.sum(axis=0, dtype=np.uint32)  # a block's counts fit the 16 bits that each has
    zero, negative = _two_counts(counts[..., NOT_POSITIVE])
    drawn, nonfinite = _two_counts(counts[..., DRAWN])
    total.drawn[cells] += drawn
    total.zero[cells] += zero
    total.nonfinite[cells] += nonfinite
    total.negative[cells] += negative
    if nonfinite.any():
        _note_first_bad(total.first_bad[cells], found[..., FIRST_BAD].min(axis=0), launch.first_block)
    return int(drawn.sum())


def _two_counts(packed: NDArray[np.uint32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The counts in the low and in the high half of words (cells, blocks), over all blocks."""
    low, high = packed & np.uint32(0xFFFF), packed >> np.uint32(16)
    return low.sum(axis=1, dtype=np.int64), high.sum(axis=1, dtype=np.int64)


def _note_first_bad(first_bad: NDArray[np.int64], found: NDArray[np.uint32], first_block: int) -> None:
    """Keep the lowest index of a non-finite sample. `found` has an index within each block, or NO_INDEX."""
    offsets = (first_block + np.arange(found.shape[1], dtype=np.int64)) * BLOCK_SAMPLES
    indices = np.where(found == NO_INDEX, np.iinfo(np.int64).max, found + offsets).min(axis=1)
    fresh = (first_bad < 0) & (indices < np.iinfo(np.int64).max)
    first_bad[fresh] = indices[fresh]


def _complete(sums: CellSums, samples: int) -> CellSums:
    if np.any(sums.drawn != samples):
        raise IncompleteRun(f"the driver ended a loop after {sums.drawn.min()} of {samples} samples")
    return sums


def _empty_sums(shift: NDArray[np.float64]) -> CellSums:
    cells = len(shift)

    def none_yet() -> NDArray[np.int64]:
        return np.zeros(cells, np.int64)

    return CellSums(
        drawn=none_yet(),
        zero=none_yet(),
        nonfinite=none_yet(),
        negative=none_yet(),
        first_bad=np.full(cells, -1, np.int64),
        shift=shift,
        powers=np.zeros((4, cells)),
        largest=np.full(cells, -np.inf),
    )
