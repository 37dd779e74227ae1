"""Adam in the eigenbases of the gradients' statistics (SOAP) [Vyas2024], as in engine/training/src/optimizer.h.

Steps can be captured as CUDA graphs. Matrices of the same shape are stacked in one tensor, so that a step is a few
batched products. The number of the step and the learning rate are tensors on the device, so that a captured step can be
replayed with other values. Bases are updated outside of the graphs: the CPU computes the eigenvectors meanwhile.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field

import numpy as np
import torch
from torch import Tensor

FIRST_DECAY = 0.95
SECOND_DECAY = 0.99
ADAM_EPSILON = 1e-8
STATISTICS_DECAY = 0.96
STATISTICS_INTERVAL = 4


@dataclass
class Stack:
    """Matrices of the same shape, with their bases (`left`, `right`), and the moments of Adam in these bases."""

    values: Tensor  # count x rows x columns
    leaf_indices: list[int]  # index of each matrix among the leaves of the optimizer
    first: Tensor = field(init=False)
    second: Tensor = field(init=False)
    left_statistics: Tensor = field(init=False)
    right_statistics: Tensor = field(init=False)
    left: Tensor = field(init=False)
    right: Tensor = field(init=False)

    def __post_init__(self) -> None:
        count, rows, columns = self.values.shape
        new = self.values.new_zeros
        self.first, self.second = new(count, rows, columns), new(count, rows, columns)
        self.left_statistics, self.right_statistics = new(count, rows, rows), new(count, columns, columns)
        self.left = new(count, rows, rows) + torch.eye(rows, dtype=self.values.dtype, device=self.values.device)
        self.right = new(count, columns, columns) + torch.eye(columns, dtype=self.values.dtype, device=self.values.device)

    def statistics(self) -> list[Tensor]:
        return [self.left_statistics, self.right_statistics]


def eigenvectors(symmetric: np.ndarray) -> np.ndarray:
    """Eigenvectors of a symmetric matrix as columns, computed in double precision."""
    return np.linalg.eigh(symmetric.astype(np.float64))[1].astype(symmetric.dtype)


class Soap:
    """The optimizer. It owns the values of all parameters; `leaves` are views of them that require gradients.

    `matrices` have bases and weight decay. `others` have neither: their steps are those of Adam.
    """

    def __init__(self, matrices: Sequence[Tensor], others: Sequence[Tensor], weight_decay: float, max_gradient_norm: float) -> None:
        self.weight_decay = weight_decay
        self.max_gradient_norm = max_gradient_norm
        like = matrices[0]
        by_shape: dict[tuple[int, ...], list[int]] = {}
        for i, matrix in enumerate(matrices):
            by_shape.setdefault(tuple(matrix.shape), []).append(i)
        self.stacks = [Stack(torch.stack([matrices[i] for i in leaf_indices]), leaf_indices) for leaf_indices in by_shape.values()]
        self.flat = torch.cat([tensor.reshape(-1) for tensor in others])
        self.flat_first, self.flat_second = torch.zeros_like(self.flat), torch.zeros_like(self.flat)
        self.steps = torch.zeros((), dtype=like.dtype, device=like.device)
        self.rate = torch.zeros((), dtype=like.dtype, device=like.device)

        self.matrix_leaves: list[Tensor] = [like] * len(matrices)
        for stack in self.stacks:
            for j, index in enumerate(stack.leaf_indices):
                self.matrix_leaves[index] = stack.values[j].detach().requires_grad_()
        self.other_leaves: list[Tensor] = []
        begin = 0
        for tensor in others:
            part = self.flat[begin : begin + tensor.numel()]
            self.other_leaves.append(part.view(tensor.shape).detach().requires_grad_())
            begin += tensor.numel()
        self.pending_bases: list[list[list[Future[np.ndarray]]]] = []

    @property
    def leaves(self) -> list[Tensor]:
        return self.matrix_leaves + self.other_leaves

    @torch.no_grad()
    def step(self, gradients: Sequence[Tensor], with_statistics: bool) -> None:
        """Makes one step with the gradients of `leaves`. If their norm is not finite, all gradients count as zero."""
        stacked = [torch.stack([gradients[index] for index in stack.leaf_indices]) for stack in self.stacks]
        flat = torch.cat([g.reshape(-1) for g in gradients[len(self.matrix_leaves) :]])
        parts = [*stacked, flat]
        norm = torch.stack([g.square().sum() for g in parts]).sum().sqrt()
        scale = (self.max_gradient_norm / norm).clamp(max=1.0)
        finite = torch.isfinite(norm)
        zero = torch.zeros_like(norm)
        parts = [torch.where(finite, g * scale, zero) for g in parts]

        self.steps += 1
        first_correction = 1 - torch.pow(FIRST_DECAY, self.steps)
        second_correction = 1 - torch.pow(SECOND_DECAY, self.steps)
        decay_factor = 1 - self.rate * self.weight_decay
        for stack, g in zip(self.stacks, parts):
            if with_statistics:
                stack.left_statistics.lerp_(torch.bmm(g, g.transpose(1, 2)), 1 - STATISTICS_DECAY)
                stack.right_statistics.lerp_(torch.bmm(g.transpose(1, 2), g), 1 - STATISTICS_DECAY)
            rotated = torch.bmm(torch.bmm(stack.left.transpose(1, 2), g), stack.right)
            change = direction(stack.first, stack.second, rotated, first_correction, second_correction)
            change = torch.bmm(torch.bmm(stack.left, change), stack.right.transpose(1, 2))
            stack.values.mul_(decay_factor).sub_(change * self.rate)
        self.flat.sub_(direction(self.flat_first, self.flat_second, parts[-1], first_correction, second_correction) * self.rate)

    def update_bases(self, workers: Executor, wait: bool = False) -> None:
        """Sets the bases that the last call requested, and requests new ones from the workers.

        If the requested bases are not ready, it waits for them or, unless `wait`, does nothing.
        """
        futures = [future for stack in self.pending_bases for side in stack for future in side]
        if not wait and not all(future.done() for future in futures):
            return
        if futures:
            self.set_bases([[np.stack([future.result() for future in side]) for side in stack] for stack in self.pending_bases])
        copies = [[side.cpu().numpy() for side in stack.statistics()] for stack in self.stacks]
        self.pending_bases = [[[workers.submit(eigenvectors, m) for m in side] for side in stack] for stack in copies]

    @torch.no_grad()
    def set_bases(self, bases: list[list[np.ndarray]]) -> None:
        """Replaces the bases of each stack by (left, right), and transforms the moments to them."""
        for stack, (left, right) in zip(self.stacks, bases):
            new_left = torch.from_numpy(left).to(stack.values.device, non_blocking=True)
            new_right = torch.from_numpy(right).to(stack.values.device, non_blocking=True)
            by_left = torch.bmm(new_left.transpose(1, 2), stack.left)
            by_right = torch.bmm(stack.right.transpose(1, 2), new_right)
            stack.first.copy_(torch.bmm(torch.bmm(by_left, stack.first), by_right))
            stack.second.copy_(torch.bmm(torch.bmm(by_left.square(), stack.second), by_right.square()))
            stack.left.copy_(new_left)
            stack.right.copy_(new_right)


def direction(first: Tensor, second: Tensor, g: Tensor, first_correction: Tensor, second_correction: Tensor) -> Tensor:
    """Updates the moments by the gradient g, and returns Adam's direction.

    The corrections 1 - decay^step remove the bias of the moments' zero start.
    """
    first.lerp_(g, 1 - FIRST_DECAY)
    second.mul_(SECOND_DECAY).addcmul_(g, g, value=1 - SECOND_DECAY)
    return (first / first_correction) / ((second / second_correction).sqrt() + ADAM_EPSILON)
