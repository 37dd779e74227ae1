"""One training on a device: steps of the optimizer as a captured graph, a rate that falls with the time, validation."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

import training_set
from batches import ENERGY, INVERSE_SQUARE, STRAIN, STRESS, Batch, Batches
from network import Shape, response
from soap import STATISTICS_INTERVAL, Soap
from training_set import ROW_TEST, VALIDATION, TrainingSet

WARM_UP_STEPS = 100
# Steps between renewals of the bases; the first ones change quickly.
BASIS_INTERVAL = 100
FIRST_RENEWALS = (4, 20, 52)
# Rows of less energy (MPa) are no measure of errors.
LEAST_JUDGED_ENERGY = 1e-5
JUDGED_AT_ONCE = 4096


@dataclass
class Errors:
    """Mean relative errors of the stress and the energy, and the median of the former."""

    stress: float
    energy: float
    median_stress: float

    def __str__(self) -> str:
        return f"stress {100 * self.stress:.3f} % (median {100 * self.median_stress:.3f}), energy {100 * self.energy:.3f} %"


def row_losses(batch: Batch, energy: Tensor, stress: Tensor, along: Tensor, weights: Sequence[Tensor | float], floor: float) -> Tensor:
    """The robust loss of each row, chunks x rows; `weights` are those of the energy, the stress and the tangent."""

    def of_square(square: Tensor) -> Tensor:
        return torch.log1p((square + floor * floor).sqrt())

    rows = batch.rows
    by_energy = of_square((energy / rows[..., ENERGY] - 1).square())
    by_stress = of_square((stress - rows[..., STRESS]).square().sum(2) * rows[..., INVERSE_SQUARE])
    by_tangent = of_square((along - batch.along).square())
    return weights[0] * by_energy + weights[1] * by_stress + weights[2] * by_tangent


class Training:
    """Trains the network of a set. `prepare` one after the other; then each may `run` in a thread of its own."""

    def __init__(self, data: TrainingSet, device: torch.device, seconds: float, workers: Executor) -> None:
        options = data.options
        self.data = data
        self.device = device
        self.seconds = seconds
        self.workers = workers
        self.shape = Shape.of(options)
        self.floor = float(options["error_floor"])
        self.energy_weight, self.stress_weight = float(options["energy_weight"]), float(options["stress_weight"])
        self.full_tangent_weight = float(options["tangent_weight"])
        self.tangent_begin = float(options["tangent_begin"])
        self.rates = float(options["learning_rate"]), float(options["last_learning_rate"])
        self.stream = torch.cuda.Stream(device) if device.type == "cuda" else None
        self.batches = Batches(data, int(options["chunk_rows"]), int(options["batch_chunks"]), device, int(options["seed"]))
        numbers = [torch.from_numpy(tensor).to(device) for tensor in data.network]
        frozen = options["freeze_stiffness"] == "1"
        self.frozen = numbers[self.shape.stiffness :] if frozen else []
        self.learning = numbers[: self.shape.stiffness] if frozen else numbers
        matrices, others = self.parted(self.learning)
        self.optimizer = Soap(matrices, others, float(options["weight_decay"]), float(options["largest_gradient"]))
        self.tangent_weight = torch.zeros((), device=device)
        self.loss_sum = torch.zeros((), device=device)
        self.steps = 0
        self.shuffles = 0
        self.graph: torch.cuda.CUDAGraph | None = None

    def is_matrix(self, place: int, tensor: Tensor) -> bool:
        return tensor.dim() == 2 and place < self.shape.stiffness

    def parted(self, numbers: Sequence[Tensor]) -> tuple[list[Tensor], list[Tensor]]:
        """The matrices that have bases, and all else. The one where the branches meet is two: bases of its whole would cost more."""
        matrices: list[Tensor] = []
        others: list[Tensor] = []
        for place, tensor in enumerate(numbers):
            if place == self.shape.trunk:
                matrices += [tensor[:, : self.shape.width], tensor[:, self.shape.width :]]
            else:
                (matrices if self.is_matrix(place, tensor) else others).append(tensor)
        return matrices, others

    def parameters(self) -> list[Tensor]:
        """The network's tensors in their order, from the optimizer's leaves."""
        matrices, others = iter(self.optimizer.matrix_leaves), iter(self.optimizer.other_leaves)
        made = []
        for place, tensor in enumerate(self.learning):
            if place == self.shape.trunk:
                made.append(torch.cat([next(matrices), next(matrices)], 1))
            else:
                made.append(next(matrices) if self.is_matrix(place, tensor) else next(others))
        return made + list(self.frozen)

    def network(self) -> list[np.ndarray]:
        return [tensor.detach().cpu().numpy() for tensor in self.parameters()]

    def loss_and_gradients(self, batch: Batch) -> tuple[Tensor, list[Tensor]]:
        """Mean loss of the batch's rows, and its gradient by the optimizer's leaves."""
        strain, directions = batch.rows[..., STRAIN], batch.directions
        answer = response(self.shape, self.parameters(), batch.inputs, strain, directions)
        assert answer.along is not None
        weights = (self.energy_weight, self.stress_weight, self.tangent_weight)
        losses = row_losses(batch, answer.energy, answer.stress, answer.along, weights, self.floor)
        loss = (losses * batch.mask).sum() / batch.mask.sum()
        leaves = self.optimizer.leaves
        gradients = torch.autograd.grad(loss, leaves, allow_unused=True)
        return loss.detach(), [torch.zeros_like(leaf) if g is None else g for g, leaf in zip(gradients, leaves)]

    def some_steps(self) -> None:
        """As many steps as the statistics wait between their updates. All that a graph repeats."""
        for i in range(STATISTICS_INTERVAL):
            loss, gradients = self.loss_and_gradients(self.batches.batch())
            self.loss_sum += loss
            self.optimizer.step(gradients, with_statistics=i == 0)

    def prepare(self) -> None:
        """On a GPU, captures the steps; they need kernels that earlier steps have loaded, and these count as well."""
        if self.stream is None:
            return
        self.stream.wait_stream(torch.cuda.current_stream(self.device))
        with torch.cuda.stream(self.stream):
            for _ in range(2):
                self.begin_steps(0)
                if self.shuffles == 0 or self.steps % (self.batches.steps) == 0:
                    self.shuffle()
                self.some_steps()
                self.end_steps()
            self.stream.synchronize()
            self.graph = torch.cuda.CUDAGraph()
            with torch.cuda.graph(self.graph, stream=self.stream):
                self.some_steps()
            self.stream.synchronize()

    def shuffle(self) -> None:
        self.batches.shuffle()
        self.shuffles += 1

    def begin_steps(self, share: float) -> None:
        """Sets what depends on the share of the time that is over."""
        highest, last = self.rates
        rate = last + (highest - last) * 0.5 * (1 + math.cos(math.pi * min(share, 1)))
        self.optimizer.rate.fill_(rate * min(1, (self.steps + 1) / WARM_UP_STEPS))
        self.tangent_weight.fill_(self.full_tangent_weight if share >= self.tangent_begin else 0)

    def end_steps(self) -> None:
        self.steps += STATISTICS_INTERVAL
        if self.steps in FIRST_RENEWALS:
            self.optimizer.renew_bases(self.workers)
            self.optimizer.renew_bases(self.workers, wait=True)
        elif self.steps % BASIS_INTERVAL == 0:
            self.optimizer.renew_bases(self.workers)

    @property
    def epochs(self) -> float:
        return self.steps * self.batches.batch_chunks / self.batches.chunks

    @torch.no_grad()
    def errors(self, part: int) -> Errors:
        """Over the rows of a part that are a measure."""
        rows = np.flatnonzero((self.data.part_of_row == part) & (self.data.energy[:, 0] >= LEAST_JUDGED_ENERGY))
        designs = torch.from_numpy(self.data.design_of_row[rows].astype(np.int64)).to(self.device)
        index = torch.from_numpy(rows).to(self.device)
        parameters = self.parameters()
        by_stress, by_energy = [], []
        for begin in range(0, len(rows), JUDGED_AT_ONCE):
            some = slice(begin, begin + JUDGED_AT_ONCE)
            exact = self.batches.table[index[some]]
            answer = response(self.shape, parameters, self.batches.inputs[designs[some]], exact[:, None, STRAIN], None)
            away = (answer.stress[:, 0] - exact[:, STRESS]).norm(dim=1)
            by_stress.append(away / exact[:, STRESS].norm(dim=1))
            by_energy.append((answer.energy[:, 0] / exact[:, ENERGY] - 1).abs())
        stress, energy = torch.cat(by_stress).cpu().numpy(), torch.cat(by_energy).cpu().numpy()
        return Errors(float(stress.mean()), float(energy.mean()), float(np.median(stress)))

    def save(self, out: Path, seconds: float) -> None:
        training = {
            "epochs": f"{self.epochs:.0f}",
            "steps": str(self.steps),
            "batch_chunks": str(self.batches.batch_chunks),
            "tangent_begin": str(self.tangent_begin),
            "learning_rate": str(self.rates[0]),
            "last_learning_rate": str(self.rates[1]),
            "weight_decay": str(self.optimizer.weight_decay),
            "trainer": "pytorch",
            "device": self.device.type,
        }
        training_set.write_trained(out, self.data, self.network(), training, seconds)

    def run(self, out: Path, report: Callable[[str], None], interval: float = 30) -> None:
        """Trains until the time is over; writes `out` and reports at every interval (seconds) and at the end."""
        if self.stream is None:
            self.run_on_stream(out, report, interval)
            return
        with torch.cuda.stream(self.stream):
            self.run_on_stream(out, report, interval)

    def run_on_stream(self, out: Path, report: Callable[[str], None], interval: float) -> None:
        begin = time.monotonic()
        reported = begin
        steps_before = self.steps
        self.loss_sum.zero_()
        # The processor may be two shuffles ahead of the device.
        ahead: deque[torch.cuda.Event] = deque()
        while (elapsed := time.monotonic() - begin) < self.seconds:
            self.shuffle()
            for _ in range(self.batches.steps // STATISTICS_INTERVAL):
                self.begin_steps((time.monotonic() - begin) / self.seconds)
                if self.graph is not None:
                    self.graph.replay()
                else:
                    self.some_steps()
                self.end_steps()
                if self.stream is None and time.monotonic() - begin > self.seconds:
                    break
            if self.stream is not None:
                ahead.append(torch.cuda.Event())
                ahead[-1].record()
                if len(ahead) > 2:
                    ahead.popleft().synchronize()
            if time.monotonic() - reported >= interval:
                reported = time.monotonic()
                loss = float(self.loss_sum) / (self.steps - steps_before)
                self.loss_sum.zero_()
                steps_before = self.steps
                self.save(out, reported - begin)
                report(f"{elapsed:.0f} s, epoch {self.epochs:.1f}, step {self.steps}, loss {loss:.4f}; validation {self.errors(VALIDATION)}")
        seconds = time.monotonic() - begin
        self.save(out, seconds)
        known = f"other states of known designs {self.errors(ROW_TEST)}"
        report(f"ended after {seconds:.0f} s, epoch {self.epochs:.1f}, step {self.steps}; validation {self.errors(VALIDATION)}; {known}")
