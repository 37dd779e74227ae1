"""Adam in the eigenbases of the gradients' statistics (SOAP), as engine/training/src/optimizer.h has it, for graphs.

Matrices of one shape are one tensor, so that a step is a few batched products. What a step reads that changes (its
number, the rate) lies on the device, and a captured step can be replayed. Bases are renewed outside of the graphs:
processors find the eigenvectors while the steps go on.
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
SMALLEST_DEVIATION = 1e-8
STATISTICS_DECAY = 0.96
STATISTICS_INTERVAL = 4


@dataclass
class Stack:
    """Matrices of one shape: count x rows x columns, with their moments in the bases and the bases themselves."""

    values: Tensor
    places: list[int]  # of its matrices among the leaves
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
    """Eigenvectors of one symmetric matrix as columns, found in double precision."""
    return np.linalg.eigh(symmetric.astype(np.float64))[1].astype(symmetric.dtype)


class Soap:
    """Owns the numbers of all parameters; `leaves` are views of them, in which gradients are asked for.

    `matrices` go into bases and, with a weight decay, shrink; `others` are Adam's alone. `frozen` never change.
    """

    def __init__(self, matrices: Sequence[Tensor], others: Sequence[Tensor], weight_decay: float, largest_gradient: float) -> None:
        self.weight_decay = weight_decay
        self.largest_gradient = largest_gradient
        like = matrices[0]
        by_shape: dict[tuple[int, ...], list[int]] = {}
        for i, matrix in enumerate(matrices):
            by_shape.setdefault(tuple(matrix.shape), []).append(i)
        self.stacks = [Stack(torch.stack([matrices[i] for i in places]), places) for places in by_shape.values()]
        self.flat = torch.cat([tensor.reshape(-1) for tensor in others])
        self.flat_first, self.flat_second = torch.zeros_like(self.flat), torch.zeros_like(self.flat)
        self.steps = torch.zeros((), dtype=like.dtype, device=like.device)
        self.rate = torch.zeros((), dtype=like.dtype, device=like.device)

        self.matrix_leaves: list[Tensor] = [like] * len(matrices)
        for stack in self.stacks:
            for j, place in enumerate(stack.places):
                self.matrix_leaves[place] = stack.values[j].detach().requires_grad_()
        self.other_leaves: list[Tensor] = []
        begin = 0
        for tensor in others:
            part = self.flat[begin : begin + tensor.numel()]
            self.other_leaves.append(part.view(tensor.shape).detach().requires_grad_())
            begin += tensor.numel()
        self.renewal: list[list[list[Future[np.ndarray]]]] = []

    @property
    def leaves(self) -> list[Tensor]:
        return self.matrix_leaves + self.other_leaves

    @torch.no_grad()
    def step(self, gradients: Sequence[Tensor], with_statistics: bool) -> None:
        """One step with the gradients of `leaves`. A gradient that is not finite counts as zero."""
        stacked = [torch.stack([gradients[place] for place in stack.places]) for stack in self.stacks]
        flat = torch.cat([g.reshape(-1) for g in gradients[len(self.matrix_leaves) :]])
        parts = [*stacked, flat]
        norm = torch.stack([g.square().sum() for g in parts]).sum().sqrt()
        scale = (self.largest_gradient / norm).clamp(max=1.0)
        finite = torch.isfinite(norm)
        zero = torch.zeros_like(norm)
        parts = [torch.where(finite, g * scale, zero) for g in parts]

        self.steps += 1
        first_share = 1 - torch.pow(FIRST_DECAY, self.steps)
        second_share = 1 - torch.pow(SECOND_DECAY, self.steps)
        keep = 1 - self.rate * self.weight_decay
        for stack, g in zip(self.stacks, parts):
            if with_statistics:
                stack.left_statistics.lerp_(torch.bmm(g, g.transpose(1, 2)), 1 - STATISTICS_DECAY)
                stack.right_statistics.lerp_(torch.bmm(g.transpose(1, 2), g), 1 - STATISTICS_DECAY)
            turned = torch.bmm(torch.bmm(stack.left.transpose(1, 2), g), stack.right)
            change = direction(stack.first, stack.second, turned, first_share, second_share)
            change = torch.bmm(torch.bmm(stack.left, change), stack.right.transpose(1, 2))
            stack.values.mul_(keep).sub_(change * self.rate)
        self.flat.sub_(direction(self.flat_first, self.flat_second, parts[-1], first_share, second_share) * self.rate)

    def renew_bases(self, workers: Executor, wait: bool = False) -> None:
        """Takes the bases asked for by the last call, and asks for the next ones; unless it waits, only if they are ready."""
        futures = [future for stack in self.renewal for side in stack for future in side]
        if not wait and not all(future.done() for future in futures):
            return
        if futures:
            self.take_bases([[np.stack([future.result() for future in side]) for side in stack] for stack in self.renewal])
        copies = [[side.cpu().numpy() for side in stack.statistics()] for stack in self.stacks]
        self.renewal = [[[workers.submit(eigenvectors, m) for m in side] for side in stack] for stack in copies]

    @torch.no_grad()
    def take_bases(self, bases: list[list[np.ndarray]]) -> None:
        for stack, (left, right) in zip(self.stacks, bases):
            new_left = torch.from_numpy(left).to(stack.values.device, non_blocking=True)
            new_right = torch.from_numpy(right).to(stack.values.device, non_blocking=True)
            by_left = torch.bmm(new_left.transpose(1, 2), stack.left)
            by_right = torch.bmm(stack.right.transpose(1, 2), new_right)
            stack.first.copy_(torch.bmm(torch.bmm(by_left, stack.first), by_right))
            stack.second.copy_(torch.bmm(torch.bmm(by_left.square(), stack.second), by_right.square()))
            stack.left.copy_(new_left)
            stack.right.copy_(new_right)


def direction(first: Tensor, second: Tensor, g: Tensor, first_share: Tensor, second_share: Tensor) -> Tensor:
    """Adam's direction; takes g into the moments."""
    first.lerp_(g, 1 - FIRST_DECAY)
    second.mul_(SECOND_DECAY).addcmul_(g, g, value=1 - SECOND_DECAY)
    return (first / first_share) / ((second / second_share).sqrt() + SMALLEST_DEVIATION)
