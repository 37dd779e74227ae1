"""Rows on the device, to which every symmetry has been applied, and the random order in which a training uses them.

A row is a simulated state of a design. A chunk is some rows of one design, for which the network evaluates the design
once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from training_set import TRAINING, TrainingSet

# Columns of the table: strain e, stress S, energy, W (maps unit vectors to strains v with v^T C v = 1, where C is the
# tangent), M = W^T C W, 1 / |S|^2.
STRAIN, STRESS, ENERGY, WHITENING, WHITE_TANGENT, INVERSE_SQUARE = slice(0, 3), slice(3, 6), 6, slice(7, 16), slice(16, 25), 25


def full_matrices(packed: np.ndarray) -> np.ndarray:
    """Symmetric 3 x 3 matrices from rows of their entries 11, 12, 13, 22, 23, 33."""
    return packed[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)


def table_of(data: TrainingSet) -> np.ndarray:
    """The table, symmetries x rows x 26. A symmetry maps e -> A e, S -> A^-T S, W -> A W, and does not change M."""
    whitening, tangent = full_matrices(data.whitening.astype(np.float64)), full_matrices(data.tangent.astype(np.float64))
    white_tangent = whitening.transpose(0, 2, 1) @ tangent @ whitening
    tables = []
    for strain_map in data.strain_maps.astype(np.float64):
        a = strain_map.reshape(3, 3)
        strain = data.strain @ a.T
        stress = data.stress @ np.linalg.inv(a)
        columns = [strain, stress, data.energy, (a @ whitening).reshape(-1, 9), white_tangent.reshape(-1, 9)]
        columns.append(1 / np.maximum(np.square(stress).sum(1, keepdims=True), 1e-300))
        tables.append(np.concatenate(columns, 1))
    return np.stack(tables).astype(np.float32)


@dataclass
class Batch:
    """The chunks of one step, all with the same number of rows. Rows with mask 0 only fill up shorter chunks."""

    inputs: Tensor  # chunks x inputs of the network for a design
    rows: Tensor  # chunks x rows x 26
    mask: Tensor  # chunks x rows
    unit: Tensor  # random unit vectors, chunks x rows x 3

    @property
    def directions(self) -> Tensor:
        """The directions v = W unit of the tangent's loss, chunks x rows x 3."""
        return torch.matmul(self.rows[..., WHITENING].unflatten(2, (3, 3)), self.unit.unsqueeze(3)).squeeze(3)

    @property
    def along(self) -> Tensor:
        """The simulated stiffness v^T C v along the directions, chunks x rows."""
        white_tangent = self.rows[..., WHITE_TANGENT].unflatten(2, (3, 3))
        return (torch.matmul(white_tangent, self.unit.unsqueeze(3)).squeeze(3) * self.unit).sum(2)


class Batches:
    """The training rows. `shuffle` draws batches for many steps, and `batch` returns the next one. Both use the device alone."""

    def __init__(self, data: TrainingSet, chunk_rows: int, batch_chunks: int, device: torch.device, seed: int) -> None:
        self.generator = torch.Generator(device=device).manual_seed(seed)
        table = table_of(data)
        self.row_count = table.shape[1]
        self.table = torch.from_numpy(table.reshape(-1, table.shape[2])).to(device)
        self.inputs = torch.from_numpy(data.inputs.astype(np.float32)).to(device)
        self.designs = data.usable.shape[0]
        rows = np.flatnonzero(data.part_of_row == TRAINING)
        self.rows = torch.from_numpy(rows).to(device)
        self.design_of = torch.from_numpy(data.design_of_row[rows].astype(np.float64)).to(device)
        positions, masks, designs = split_into_chunks(data.design_of_row[rows], chunk_rows)
        self.positions = torch.from_numpy(positions).to(device)
        self.masks = torch.from_numpy(masks).to(device)
        self.chunk_design = torch.from_numpy(designs).to(device)
        self.symmetries, self.symmetry_count = self.usable_symmetries(data.usable, device)
        self.chunks = len(designs)
        self.batch_chunks = min(batch_chunks, self.chunks)
        self.chunk_rows = chunk_rows
        # Batches for about an epoch are drawn at once. The number of steps is a multiple of four, because a captured
        # graph makes four steps.
        self.steps = 4 * max(1, round(self.chunks / self.batch_chunks / 4))
        batch_shape = (self.steps, self.batch_chunks)
        # The number of the next step, and for each step the rows of the table, the inputs, masks and unit vectors.
        self.next = torch.zeros(1, dtype=torch.int64, device=device)
        self.row_of = torch.zeros(*batch_shape, chunk_rows, dtype=torch.int64, device=device)
        self.input_of = torch.zeros(batch_shape, dtype=torch.int64, device=device)
        self.mask_of = torch.zeros(*batch_shape, chunk_rows, device=device)
        self.unit_of = torch.zeros(*batch_shape, chunk_rows, 3, device=device)

    @property
    def epochs_of_a_shuffle(self) -> float:
        return self.steps * self.batch_chunks / self.chunks

    @staticmethod
    def usable_symmetries(usable: np.ndarray, device: torch.device) -> tuple[Tensor, Tensor]:
        """For each design the numbers of its usable symmetries, at the beginning of a row, and how many they are."""
        order = np.argsort(-usable, axis=1, kind="stable")
        count = np.count_nonzero(usable, axis=1)
        return torch.from_numpy(order).to(device), torch.from_numpy(count).to(device)

    @torch.no_grad()
    def shuffle(self) -> None:
        """Shuffles the rows of each design and the chunks, and draws a symmetry for each chunk and unit vectors."""
        device = self.table.device

        def draw(*size: int) -> Tensor:
            return torch.rand(*size, generator=self.generator, device=device)

        # The integer part of a key is the design, so that sorting shuffles the rows within each design.
        keys = self.design_of + 0.999 * draw(len(self.rows)).double()
        shuffled = self.rows[torch.argsort(keys)]
        chunk_count = self.steps * self.batch_chunks
        passes = -(-chunk_count // self.chunks)
        order = torch.cat([torch.argsort(draw(self.chunks)) for _ in range(passes)])[:chunk_count]
        design = self.chunk_design[order]
        drawn = (draw(chunk_count) * self.symmetry_count[design]).long().clamp(max=self.symmetries.shape[1] - 1)
        symmetry = self.symmetries[design, drawn]
        self.input_of.copy_((symmetry * self.designs + design).view_as(self.input_of))
        rows = shuffled[self.positions[order]] + symmetry.unsqueeze(1) * self.row_count
        self.row_of.copy_(rows.view_as(self.row_of))
        self.mask_of.copy_(self.masks[order].view_as(self.mask_of))
        normal = torch.randn(self.unit_of.shape, generator=self.generator, device=device)
        self.unit_of.copy_(torch.nn.functional.normalize(normal, dim=3))
        self.next.zero_()

    def batch(self) -> Batch:
        def current(table: Tensor) -> Tensor:
            return table.index_select(0, self.next).squeeze(0)

        rows = self.table.index_select(0, current(self.row_of).reshape(-1)).reshape(self.batch_chunks, self.chunk_rows, -1)
        batch = Batch(self.inputs.index_select(0, current(self.input_of)), rows, current(self.mask_of), current(self.unit_of))
        self.next += 1
        return batch


def split_into_chunks(design_of_row: np.ndarray, chunk_rows: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Splits the rows of each design into chunks of nearly equal length of at most `chunk_rows` rows.

    Returns the rows' positions (chunks x chunk_rows), a mask of them, and the design of each chunk. Shorter chunks are
    filled up with their first row, where the mask is 0.
    """
    positions, masks, designs = [], [], []
    first = np.flatnonzero(np.r_[True, design_of_row[1:] != design_of_row[:-1]])
    for begin, end in zip(first, np.r_[first[1:], len(design_of_row)]):
        n = end - begin
        count = -(-n // chunk_rows)
        for i in range(count):
            chunk = np.arange(begin + i * n // count, begin + (i + 1) * n // count)
            positions.append(np.r_[chunk, np.full(chunk_rows - len(chunk), chunk[0])])
            masks.append(np.r_[np.ones(len(chunk), np.float32), np.zeros(chunk_rows - len(chunk), np.float32)])
            designs.append(design_of_row[begin])
    return np.stack(positions), np.stack(masks).astype(np.float32), np.array(designs, dtype=np.int64)
