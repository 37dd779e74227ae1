"""Rows on the device, already seen through every symmetry, and the order in which a training meets them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from training_set import TRAINING, TrainingSet

# Columns of the table: e, S, energy, W (maps unit vectors to strains v with v^T C v = 1), M = W^T C W, 1 / |S|^2.
STRAIN, STRESS, ENERGY, WHITENING, WHITE_TANGENT, INVERSE_SQUARE = slice(0, 3), slice(3, 6), 6, slice(7, 16), slice(16, 25), 25


def full(six: np.ndarray) -> np.ndarray:
    return six[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)


def table_of(data: TrainingSet) -> np.ndarray:
    """Symmetries x rows x 26; e -> A e, S -> A^-T S, W -> A W, and M stays."""
    whitening, tangent = full(data.whitening.astype(np.float64)), full(data.tangent.astype(np.float64))
    white = whitening.transpose(0, 2, 1) @ tangent @ whitening
    tables = []
    for number in data.strain_maps.astype(np.float64):
        a = number.reshape(3, 3)
        strain = data.strain @ a.T
        stress = data.stress @ np.linalg.inv(a)
        columns = [strain, stress, data.energy, (a @ whitening).reshape(-1, 9), white.reshape(-1, 9)]
        columns.append(1 / np.maximum(np.square(stress).sum(1, keepdims=True), 1e-300))
        tables.append(np.concatenate(columns, 1))
    return np.stack(tables).astype(np.float32)


@dataclass
class Batch:
    """Chunks of rows of one design each; where a chunk has fewer rows, the mask is 0."""

    inputs: Tensor  # chunks x inputs
    rows: Tensor  # chunks x rows x 26
    mask: Tensor  # chunks x rows
    unit: Tensor  # chunks x rows x 3: unit vectors

    @property
    def directions(self) -> Tensor:
        return torch.matmul(self.rows[..., WHITENING].unflatten(2, (3, 3)), self.unit.unsqueeze(3)).squeeze(3)

    @property
    def along(self) -> Tensor:
        """v^T C v of the directions, as simulated."""
        white = self.rows[..., WHITE_TANGENT].unflatten(2, (3, 3))
        return (torch.matmul(white, self.unit.unsqueeze(3)).squeeze(3) * self.unit).sum(2)


class Batches:
    """The training's rows. `shuffle` draws the next steps, `batch` is the next of them; both work on the device alone."""

    def __init__(self, data: TrainingSet, chunk_rows: int, batch_chunks: int, device: torch.device, seed: int) -> None:
        self.generator = torch.Generator(device=device).manual_seed(seed)
        table = table_of(data)
        self.all_rows = table.shape[1]
        self.table = torch.from_numpy(table.reshape(-1, table.shape[2])).to(device)
        self.inputs = torch.from_numpy(data.inputs.astype(np.float32)).to(device)
        self.designs = data.usable.shape[0]
        rows = np.flatnonzero(data.part_of_row == TRAINING)
        self.rows = torch.from_numpy(rows).to(device)
        self.design_of = torch.from_numpy(data.design_of_row[rows].astype(np.float64)).to(device)
        positions, masks, designs = pieces(data.design_of_row[rows], chunk_rows)
        self.positions = torch.from_numpy(positions).to(device)
        self.masks = torch.from_numpy(masks).to(device)
        self.chunk_design = torch.from_numpy(designs).to(device)
        self.symmetries, self.symmetry_count = self.usable_symmetries(data.usable, device)
        self.chunks = len(designs)
        self.batch_chunks = min(batch_chunks, self.chunks)
        self.chunk_rows = chunk_rows
        # A multiple of four steps is drawn at once: about an epoch.
        self.steps = 4 * max(1, round(self.chunks / self.batch_chunks / 4))
        wanted = (self.steps, self.batch_chunks)
        self.next = torch.zeros(1, dtype=torch.int64, device=device)
        self.row_of = torch.zeros(*wanted, chunk_rows, dtype=torch.int64, device=device)
        self.input_of = torch.zeros(wanted, dtype=torch.int64, device=device)
        self.mask_of = torch.zeros(*wanted, chunk_rows, device=device)
        self.unit_of = torch.zeros(*wanted, chunk_rows, 3, device=device)

    @property
    def epochs_of_a_shuffle(self) -> float:
        return self.steps * self.batch_chunks / self.chunks

    @staticmethod
    def usable_symmetries(usable: np.ndarray, device: torch.device) -> tuple[Tensor, Tensor]:
        """For each design the numbers of its symmetries, and how many these are."""
        order = np.argsort(-usable, axis=1, kind="stable")
        count = np.count_nonzero(usable, axis=1)
        return torch.from_numpy(order).to(device), torch.from_numpy(count).to(device)

    @torch.no_grad()
    def shuffle(self) -> None:
        device = self.table.device

        def draw(*size: int) -> Tensor:
            return torch.rand(*size, generator=self.generator, device=device)

        # Rows stay with their design and change places within it.
        keys = self.design_of + 0.999 * draw(len(self.rows)).double()
        shuffled = self.rows[torch.argsort(keys)]
        wanted = self.steps * self.batch_chunks
        rounds = -(-wanted // self.chunks)
        order = torch.cat([torch.argsort(draw(self.chunks)) for _ in range(rounds)])[:wanted]
        design = self.chunk_design[order]
        drawn = (draw(wanted) * self.symmetry_count[design]).long().clamp(max=self.symmetries.shape[1] - 1)
        symmetry = self.symmetries[design, drawn]
        self.input_of.copy_((symmetry * self.designs + design).view_as(self.input_of))
        rows = shuffled[self.positions[order]] + symmetry.unsqueeze(1) * self.all_rows
        self.row_of.copy_(rows.view_as(self.row_of))
        self.mask_of.copy_(self.masks[order].view_as(self.mask_of))
        normal = torch.randn(self.unit_of.shape, generator=self.generator, device=device)
        self.unit_of.copy_(torch.nn.functional.normalize(normal, dim=3))
        self.next.zero_()

    def batch(self) -> Batch:
        def of(table: Tensor) -> Tensor:
            return table.index_select(0, self.next).squeeze(0)

        rows = self.table.index_select(0, of(self.row_of).reshape(-1)).reshape(self.batch_chunks, self.chunk_rows, -1)
        batch = Batch(self.inputs.index_select(0, of(self.input_of)), rows, of(self.mask_of), of(self.unit_of))
        self.next += 1
        return batch


def pieces(design_of_row: np.ndarray, chunk_rows: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cuts the rows of each design into pieces of nearly equal length of at most `chunk_rows` rows.

    Returns the rows' positions (chunks x chunk_rows), which of them count, and the design of each piece.
    """
    positions, masks, designs = [], [], []
    first = np.flatnonzero(np.r_[True, design_of_row[1:] != design_of_row[:-1]])
    for begin, end in zip(first, np.r_[first[1:], len(design_of_row)]):
        n = end - begin
        count = -(-n // chunk_rows)
        for i in range(count):
            piece = np.arange(begin + i * n // count, begin + (i + 1) * n // count)
            positions.append(np.r_[piece, np.full(chunk_rows - len(piece), piece[0])])
            masks.append(np.r_[np.ones(len(piece), np.float32), np.zeros(chunk_rows - len(piece), np.float32)])
            designs.append(design_of_row[begin])
    return np.stack(positions), np.stack(masks).astype(np.float32), np.array(designs, dtype=np.int64)
