"""The network of engine/training/src/torch_network.h, in PyTorch: energies, stresses and tangents by jets.

A jet carries a value, its three derivatives with respect to the strain e = (E_xx, E_yy, 2 E_xy) and, along one direction
v for each row, the second derivative: five channels that go forward through the layers together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

import activation

# The evaluator bounds exponents in the same way, so that a stiffness stays a finite number far from the data.
LARGEST_LOG_FACTOR = 20.0


@dataclass(frozen=True)
class Shape:
    """Sizes of a network, by the names that supple-lab gives them."""

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
        """The shape that options name. Raises ValueError for what this trainer does not have."""
        for name, only in (("form", "sum_of_squares"), ("activation", "swish"), ("loss", "robust"), ("optimizer", "soap")):
            if options[name] != only:
                raise ValueError(f"{name} is {options[name]}; this trainer has {only} alone.")
        sizes = ("width", "strain_layers", "parameter_layers", "trunk_layers", "residuals", "stiffness_layers", "stiffness_width")
        return Shape(**{name: int(options[name]) for name in sizes}, exact_rest=options["rest"] == "exact")

    @property
    def trunk(self) -> int:
        """Where the trunk's layers begin among the parameters: weights and bias of each layer follow each other."""
        return 2 * (self.strain_layers + self.parameter_layers)

    @property
    def stiffness(self) -> int:
        """Where the stiffness branch begins; it goes on to the end of the parameters."""
        return self.trunk + 2 * (self.trunk_layers + 1)


@dataclass
class Response:
    """Energy density (designs x rows, MPa), stress (designs x rows x 3, MPa) and v^T C v (designs x rows) of the tangent C."""

    energy: Tensor
    stress: Tensor
    along: Tensor | None


def stiffness_factor(branch: Sequence[Tensor], inputs: Tensor) -> Tensor:
    """L of each design, designs x 3 x 3: lower triangular, in sqrt(MPa)."""
    q = inputs
    for layer in range(0, len(branch), 2):
        q = torch.addmm(branch[layer + 1], q, branch[layer].t())
        if layer + 2 < len(branch):
            q = q * torch.sigmoid(q)
    return factor_of_outputs(q)


def factor_of_outputs(q: Tensor) -> Tensor:
    """L of the six outputs (log L11, log L22, log L33, L21 / L11, L31 / L11, L32 / L22)."""
    a, b, c = torch.exp(q[:, :3].clamp(-LARGEST_LOG_FACTOR, LARGEST_LOG_FACTOR)).unbind(1)
    zero = torch.zeros_like(a)
    entries = [a, zero, zero, q[:, 3] * a, b, zero, q[:, 4] * a, q[:, 5] * b, c]
    return torch.stack(entries, 1).reshape(-1, 3, 3)


def response(shape: Shape, parameters: Sequence[Tensor], inputs: Tensor, strain: Tensor, directions: Tensor | None) -> Response:
    """What the network answers for `strain` (designs x rows x 3) of designs (designs x inputs).

    `directions` (designs x rows x 3) are the v of v^T C v; without them four channels go forward instead of five.
    """
    designs, rows, _ = strain.shape
    w = shape.width
    factor = stiffness_factor(parameters[shape.stiffness :], inputs)
    stiffness = factor.square().sum((1, 2)) / 3
    scaled = factor.transpose(1, 2) * torch.rsqrt(stiffness).reshape(-1, 1, 1)

    h = inputs
    for layer in range(shape.parameter_layers):
        at = 2 * (shape.strain_layers + layer)
        z = torch.addmm(parameters[at + 1], h, parameters[at].t())
        h = z * torch.sigmoid(z)
    meeting_weights = parameters[shape.trunk]
    meeting = torch.addmm(parameters[shape.trunk + 1], h, meeting_weights[:, w:].t())

    # Each design has one more row, the last: its structure at rest.
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
    x = layer_of(x, meeting_weights[:, :w], meeting, rows + 1)
    for layer in range(1, shape.trunk_layers):
        at = shape.trunk + 2 * layer
        x = layer_of(x, parameters[at], parameters[at + 1].unsqueeze(0), n)
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
        turned = (slopes * directions.permute(2, 0, 1).unsqueeze(3)).sum(0)
        along = s * (turned.square().sum(2) + (value * outputs[4, :, :rows]).sum(2))
    return Response(energy, stress, along)


def inputs_of_strains(scaled: Tensor, strain: Tensor, second: bool) -> Tensor:
    """Jets of what the strain branch reads, (y, e): channels x designs x rows x 6."""
    designs, rows, _ = strain.shape
    values = torch.cat([torch.matmul(strain, scaled.transpose(1, 2)), strain], 2)
    unit = torch.eye(3, dtype=strain.dtype, device=strain.device).expand(designs, 3, 3)
    maps = torch.cat([scaled, unit], 1).permute(2, 0, 1).unsqueeze(2).expand(3, designs, rows, 6)
    channels = [values.unsqueeze(0), maps]
    if second:
        channels.append(torch.zeros_like(values).unsqueeze(0))
    return torch.cat(channels, 0)
