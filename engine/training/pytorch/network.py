"""The network of engine/training/src/torch_network.h in PyTorch. It computes energies, stresses and tangents by jets.

A jet is a value with its three derivatives with respect to the strain e = (E_xx, E_yy, 2 E_xy) and, if there is a
direction v for each row, the second derivative along v. The layers propagate these four or five channels together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

import activation

# Logarithms of factors are clamped to this size, as in the evaluator. The stiffness is therefore finite for designs far
# from the training data.
MAX_LOG_FACTOR = 20.0


@dataclass(frozen=True)
class Shape:
    """Sizes of a network. Their names are those of the options of supple-lab train."""

    width: int
    strain_layers: int
    parameter_layers: int
    trunk_layers: int
    residuals: int
    stiffness_layers: int
    stiffness_width: int
    exact_rest: bool

    @staticmethod
    def of(options: Mapping[str, str]) -> Shape:
        """Reads the shape from the options. Raises ValueError for another form, activation, loss or optimizer than this trainer has."""
        for name, only in (("form", "sum_of_squares"), ("activation", "swish"), ("loss", "robust"), ("optimizer", "soap")):
            if options[name] != only:
                raise ValueError(f"{name} is {options[name]}; this trainer has {only} alone.")
        sizes = ("width", "strain_layers", "parameter_layers", "trunk_layers", "residuals", "stiffness_layers", "stiffness_width")
        return Shape(**{name: int(options[name]) for name in sizes}, exact_rest=options["rest"] == "exact")

    @property
    def trunk(self) -> int:
        """The index of the trunk's first tensor. Each layer has two tensors: weights, then bias."""
        return 2 * (self.strain_layers + self.parameter_layers)

    @property
    def stiffness(self) -> int:
        """The index of the stiffness branch's first tensor. It is the last branch."""
        return self.trunk + 2 * (self.trunk_layers + 1)


@dataclass
class Response:
    """What the network predicts, in MPa."""

    energy: Tensor  # energy density, designs x rows
    stress: Tensor  # designs x rows x 3
    along: Tensor | None  # stiffness v^T C v along the direction v of each row, with the tangent C; designs x rows


def stiffness_factor(branch: Sequence[Tensor], inputs: Tensor) -> Tensor:
    """The Cholesky factor L of each design's stiffness at rest, designs x 3 x 3: lower triangular, in sqrt(MPa)."""
    q = inputs
    for layer in range(0, len(branch), 2):
        q = torch.addmm(branch[layer + 1], q, branch[layer].t())
        if layer + 2 < len(branch):
            q = q * torch.sigmoid(q)
    return factor_of_outputs(q)


def factor_of_outputs(q: Tensor) -> Tensor:
    """The Cholesky factor L from the six outputs (log L11, log L22, log L33, L21 / L11, L31 / L11, L32 / L22)."""
    a, b, c = torch.exp(q[:, :3].clamp(-MAX_LOG_FACTOR, MAX_LOG_FACTOR)).unbind(1)
    zero = torch.zeros_like(a)
    entries = [a, zero, zero, q[:, 3] * a, b, zero, q[:, 4] * a, q[:, 5] * b, c]
    return torch.stack(entries, 1).reshape(-1, 3, 3)


def response(shape: Shape, parameters: Sequence[Tensor], inputs: Tensor, strain: Tensor, directions: Tensor | None) -> Response:
    """Evaluates the network at `strain` (designs x rows x 3) of designs, which are given by `inputs` (designs x inputs).

    `directions` (designs x rows x 3) are the v of v^T C v. Without them jets have four channels instead of five.
    """
    designs, rows, _ = strain.shape
    w = shape.width
    factor = stiffness_factor(parameters[shape.stiffness :], inputs)
    stiffness = factor.square().sum((1, 2)) / 3
    scaled = factor.transpose(1, 2) * torch.rsqrt(stiffness).reshape(-1, 1, 1)

    h = inputs
    for layer in range(shape.parameter_layers):
        index = 2 * (shape.strain_layers + layer)
        z = torch.addmm(parameters[index + 1], h, parameters[index].t())
        h = z * torch.sigmoid(z)
    first_trunk_weights = parameters[shape.trunk]
    design_addend = torch.addmm(parameters[shape.trunk + 1], h, first_trunk_weights[:, w:].t())

    # Each design gets one more row, the last, with zero strain.
    with_rest = torch.nn.functional.pad(strain, (0, 0, 0, 1))
    x = inputs_of_strains(scaled, with_rest, directions is not None)
    channels = x.shape[0]
    n = designs * (rows + 1)
    v = torch.zeros(n, 3, dtype=strain.dtype, device=strain.device)
    if directions is not None:
        v = torch.nn.functional.pad(directions, (0, 0, 0, 1)).reshape(n, 3)

    def layer_of(x: Tensor, weights: Tensor, addend: Tensor, rows_of_addend: int) -> Tensor:
        z = torch.mm(x.reshape(channels * n, -1), weights.t()).reshape(channels, n, w)
        return activation.jets(z, addend, v, rows_of_addend)

    for layer in range(shape.strain_layers):
        x = layer_of(x, parameters[2 * layer], parameters[2 * layer + 1].unsqueeze(0), n)
    x = layer_of(x, first_trunk_weights[:, :w], design_addend, rows + 1)
    for layer in range(1, shape.trunk_layers):
        index = shape.trunk + 2 * layer
        x = layer_of(x, parameters[index], parameters[index + 1].unsqueeze(0), n)
    last = parameters[shape.trunk + 2 * shape.trunk_layers]
    outputs = torch.mm(x.reshape(channels * n, w), last.t()).reshape(channels, designs, rows + 1, shape.residuals)
    at_rest = outputs[:, :, rows:]

    # residual_k = N_k(p, e) - N_k(p, 0) + (linear e)_k
    linear = torch.nn.functional.pad(scaled, (0, 0, 0, shape.residuals - 3))
    if shape.exact_rest:
        linear = linear - at_rest[1:4, :, 0].permute(1, 2, 0)
    value = outputs[0, :, :rows] - at_rest[0] + torch.matmul(strain, linear.transpose(1, 2))
    slopes = outputs[1:4, :, :rows] + linear.permute(2, 0, 1).unsqueeze(2)
    s = stiffness.reshape(-1, 1)
    energy = 0.5 * s * value.square().sum(2)
    stress = (s.unsqueeze(0) * (value.unsqueeze(0) * slopes).sum(3)).permute(1, 2, 0)
    along = None
    if directions is not None:
        directional_slopes = (slopes * directions.permute(2, 0, 1).unsqueeze(3)).sum(0)
        along = s * (directional_slopes.square().sum(2) + (value * outputs[4, :, :rows]).sum(2))
    return Response(energy, stress, along)


def inputs_of_strains(scaled: Tensor, strain: Tensor, second: bool) -> Tensor:
    """Jets of the strain branch's inputs (y, e) with y = scaled e: channels x designs x rows x 6."""
    designs, rows, _ = strain.shape
    values = torch.cat([torch.matmul(strain, scaled.transpose(1, 2)), strain], 2)
    unit = torch.eye(3, dtype=strain.dtype, device=strain.device).expand(designs, 3, 3)
    maps = torch.cat([scaled, unit], 1).permute(2, 0, 1).unsqueeze(2).expand(3, designs, rows, 6)
    channels = [values.unsqueeze(0), maps]
    if second:
        channels.append(torch.zeros_like(values).unsqueeze(0))
    return torch.cat(channels, 0)
