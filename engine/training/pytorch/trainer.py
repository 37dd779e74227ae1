"""A training on one device. Steps of the optimizer are captured as a CUDA graph, and the learning rate falls with time."""

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
# Steps between updates of the bases. At first they change quickly, and are also updated after FIRST_BASIS_UPDATES steps.
BASIS_INTERVAL = 100
FIRST_BASIS_UPDATES = (4, 20, 52)
# Least energy density (MPa) of the rows on which errors are measured.
MIN_EVALUATED_ENERGY = 1e-5
EVALUATION_BATCH = 4096


@dataclass
class Errors:
    """Mean relative errors of the stress and the energy, and the median of those of the stress."""

    stress: float
    energy: float
    median_stress: float

    def __str__(self) -> str:
        return f"stress {100 * self.stress:.3f} % (median {100 * self.median_stress:.3f}), energy {100 * self.energy:.3f} %"


def row_losses(batch: Batch, energy: Tensor, stress: Tensor, along: Tensor, weights: Sequence[Tensor | float], floor: float) -> Tensor:
    """The robust loss of each row, chunks x rows. `weights` are those of the energy, the stress and the tangent."""

    def loss_of_square(square: Tensor) -> Tensor:
        return torch.log1p((square + floor * floor).sqrt())

    rows = batch.rows
    energy_losses = loss_of_square((energy / rows[..., ENERGY] - 1).square())
    stress_losses = loss_of_square((stress - rows[..., STRESS]).square().sum(2) * rows[..., INVERSE_SQUARE])
    tangent_losses = loss_of_square((along - batch.along).square())
    return weights[0] * energy_losses + weights[1] * stress_losses + weights[2] * tangent_losses


class Training:
    """Trains the network of a training set. Call `prepare` for one training after the other. Then each may `run` in its own thread."""

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
        self.trainable = numbers[: self.shape.stiffness] if frozen else numbers
        matrices, others = self.split_by_bases(self.trainable)
        self.optimizer = Soap(matrices, others, float(options["weight_decay"]), float(options["largest_gradient"]))
        self.tangent_weight = torch.zeros((), device=device)
        self.loss_sum = torch.zeros((), device=device)
        self.steps = 0
        self.shuffles = 0
        self.graph: torch.cuda.CUDAGraph | None = None

    def is_matrix(self, index: int, tensor: Tensor) -> bool:
        return tensor.dim() == 2 and index < self.shape.stiffness

    def split_by_bases(self, numbers: Sequence[Tensor]) -> tuple[list[Tensor], list[Tensor]]:
        """Splits the tensors into matrices that have bases, and all others.

        The first trunk layer's weights are split into the columns of the strain branch and those of the parameter
        branch, because bases of the whole matrix would cost more.
        """
        matrices: list[Tensor] = []
        others: list[Tensor] = []
        for index, tensor in enumerate(numbers):
            if index == self.shape.trunk:
                matrices += [tensor[:, : self.shape.width], tensor[:, self.shape.width :]]
            else:
                (matrices if self.is_matrix(index, tensor) else others).append(tensor)
        return matrices, others

    def parameters(self) -> list[Tensor]:
        """The network's tensors in their order, made of the optimizer's leaves and the frozen tensors."""
        matrices, others = iter(self.optimizer.matrix_leaves), iter(self.optimizer.other_leaves)
        tensors = []
        for index, tensor in enumerate(self.trainable):
            if index == self.shape.trunk:
                tensors.append(torch.cat([next(matrices), next(matrices)], 1))
            else:
                tensors.append(next(matrices) if self.is_matrix(index, tensor) else next(others))
        return tensors + list(self.frozen)

    def network(self) -> list[np.ndarray]:
        return [tensor.detach().cpu().numpy() for tensor in self.parameters()]

    def loss_and_gradients(self, batch: Batch) -> tuple[Tensor, list[Tensor]]:
        """Mean loss of the batch's rows, and its gradients with respect to the optimizer's leaves."""
        strain, directions = batch.rows[..., STRAIN], batch.directions
        answer = response(self.shape, self.parameters(), batch.inputs, strain, directions)
        assert answer.along is not None
        weights = (self.energy_weight, self.stress_weight, self.tangent_weight)
        losses = row_losses(batch, answer.energy, answer.stress, answer.along, weights, self.floor)
        loss = (losses * batch.mask).sum() / batch.mask.sum()
        leaves = self.optimizer.leaves
        gradients = torch.autograd.grad(loss, leaves, allow_unused=True)
        return loss.detach(), [torch.zeros_like(leaf) if g is None else g for g, leaf in zip(gradients, leaves)]

    def run_graph_steps(self) -> None:
        """Makes STATISTICS_INTERVAL steps, and updates the statistics in the first. A graph captures these steps."""
        for i in range(STATISTICS_INTERVAL):
            loss, gradients = self.loss_and_gradients(self.batches.batch())
            self.loss_sum += loss
            self.optimizer.step(gradients, with_statistics=i == 0)

    def prepare(self) -> None:
        """Captures a graph of steps on a GPU. Steps before it load the kernels that it needs; they train the network as well."""
        if self.stream is None:
            return
        self.stream.wait_stream(torch.cuda.current_stream(self.device))
        with torch.cuda.stream(self.stream):
            for _ in range(2):
                self.begin_steps(0)
                if self.shuffles == 0 or self.steps % (self.batches.steps) == 0:
                    self.shuffle()
                self.run_graph_steps()
                self.end_steps()
            self.stream.synchronize()
            self.graph = torch.cuda.CUDAGraph()
            with torch.cuda.graph(self.graph, stream=self.stream):
                self.run_graph_steps()
            self.stream.synchronize()

    def shuffle(self) -> None:
        self.batches.shuffle()
        self.shuffles += 1

    def begin_steps(self, fraction: float) -> None:
        """Sets the learning rate and the weight of the tangent for the elapsed fraction of the time."""
        max_rate, final_rate = self.rates
        rate = final_rate + (max_rate - final_rate) * 0.5 * (1 + math.cos(math.pi * min(fraction, 1)))
        self.optimizer.rate.fill_(rate * min(1, (self.steps + 1) / WARM_UP_STEPS))
        self.tangent_weight.fill_(self.full_tangent_weight if fraction >= self.tangent_begin else 0)

    def end_steps(self) -> None:
        self.steps += STATISTICS_INTERVAL
        if self.steps in FIRST_BASIS_UPDATES:
            self.optimizer.update_bases(self.workers)
            self.optimizer.update_bases(self.workers, wait=True)
        elif self.steps % BASIS_INTERVAL == 0:
            self.optimizer.update_bases(self.workers)

    @property
    def epochs(self) -> float:
        return self.steps * self.batches.batch_chunks / self.batches.chunks

    @torch.no_grad()
    def errors(self, part: int) -> Errors:
        """Errors over the rows of a part of the split (VALIDATION, TEST, ...) with at least MIN_EVALUATED_ENERGY."""
        rows = np.flatnonzero((self.data.part_of_row == part) & (self.data.energy[:, 0] >= MIN_EVALUATED_ENERGY))
        designs = torch.from_numpy(self.data.design_of_row[rows].astype(np.int64)).to(self.device)
        index = torch.from_numpy(rows).to(self.device)
        parameters = self.parameters()
        stress_errors, energy_errors = [], []
        for begin in range(0, len(rows), EVALUATION_BATCH):
            block = slice(begin, begin + EVALUATION_BATCH)
            exact = self.batches.table[index[block]]
            answer = response(self.shape, parameters, self.batches.inputs[designs[block]], exact[:, None, STRAIN], None)
            distance = (answer.stress[:, 0] - exact[:, STRESS]).norm(dim=1)
            stress_errors.append(distance / exact[:, STRESS].norm(dim=1))
            energy_errors.append((answer.energy[:, 0] / exact[:, ENERGY] - 1).abs())
        stress, energy = torch.cat(stress_errors).cpu().numpy(), torch.cat(energy_errors).cpu().numpy()
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
        """Trains for `seconds`. Writes the network to `out` and reports at every interval (in seconds) and at the end."""
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
        # The CPU waits for the device when it is more than two shuffles ahead of it.
        ahead: deque[torch.cuda.Event] = deque()
        while (elapsed := time.monotonic() - begin) < self.seconds:
            self.shuffle()
            for _ in range(self.batches.steps // STATISTICS_INTERVAL):
                self.begin_steps((time.monotonic() - begin) / self.seconds)
                if self.graph is not None:
                    self.graph.replay()
                else:
                    self.run_graph_steps()
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
