"""Jets of the swish function f(z) = z sigmoid(z), with their gradient.

A jet is a value with derivatives with respect to the strain. Its channels are the value, three first derivatives and, if
there are five, the second derivative along a direction. On a GPU the forward pass and the backward pass are one kernel
each, written in Triton. On a CPU, or without Triton, PyTorch's operations compute the same.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

try:
    import triton
    import triton.language as tl
except ImportError:
    triton = None

# Whether GPUs use the kernels. The trainer switches them off if kernels_agree returns False.
use_kernels = triton is not None
BLOCK = 1024


def jets(z: Tensor, addend: Tensor, directions: Tensor, rows_of_addend: int) -> Tensor:
    """Computes the jets of f(z + addend), where z is channels x rows x width and directions are rows x 3.

    The first row of `addend` is added to the values of the first `rows_of_addend` rows, and so on.
    """
    return Jets.apply(z, addend, directions, rows_of_addend)


class Jets(torch.autograd.Function):
    """Differentiable once, with respect to z and the addend."""

    @staticmethod
    def forward(context: Any, z: Tensor, addend: Tensor, directions: Tensor, rows_of_addend: int) -> Tensor:
        context.save_for_backward(z, addend, directions)
        context.rows_of_addend = rows_of_addend
        if z.is_cuda and use_kernels:
            return forward_by_kernel(z.contiguous(), addend.contiguous(), directions, rows_of_addend)
        return forward_plain(z, addend, directions, rows_of_addend)

    @staticmethod
    def backward(context: Any, grad_y: Tensor) -> tuple[Tensor | None, ...]:
        z, addend, directions = context.saved_tensors
        backward_function = backward_by_kernel if z.is_cuda and use_kernels else backward_plain
        grad_z = backward_function(z.contiguous(), addend.contiguous(), directions, context.rows_of_addend, grad_y.contiguous())
        return grad_z, grad_z[0].reshape(addend.shape[0], -1, addend.shape[1]).sum(1), None, None


def values_of(z: Tensor, addend: Tensor, rows_of_addend: int) -> Tensor:
    return (z[0].reshape(addend.shape[0], -1, addend.shape[1]) + addend.unsqueeze(1)).reshape(z.shape[1:])


def forward_plain(z: Tensor, addend: Tensor, directions: Tensor, rows_of_addend: int) -> Tensor:
    value = values_of(z, addend, rows_of_addend)
    s = torch.sigmoid(value)
    q = s * (1 - s)
    slope = s + value * q
    channels = [(value * s).unsqueeze(0), slope * z[1:4]]
    if z.shape[0] > 4:
        along = (z[1:4] * directions.t().unsqueeze(2)).sum(0)
        curvature = q * (2 + value * (1 - 2 * s))
        channels.append((slope * z[4] + curvature * along.square()).unsqueeze(0))
    return torch.cat(channels, 0)


def backward_plain(z: Tensor, addend: Tensor, directions: Tensor, rows_of_addend: int, grad_y: Tensor) -> Tensor:
    value = values_of(z, addend, rows_of_addend)
    s = torch.sigmoid(value)
    q = s * (1 - s)
    h = 1 - 2 * s
    slope = s + value * q
    curvature = q * (2 + value * h)
    grad_value = grad_y[0] * slope + curvature * (grad_y[1:4] * z[1:4]).sum(0)
    grad_first = grad_y[1:4] * slope
    if z.shape[0] == 4:
        return torch.cat([grad_value.unsqueeze(0), grad_first], 0)
    third = q * (3 * h + value * (h * h - 2 * q))
    v = directions.t().unsqueeze(2)
    along = (z[1:4] * v).sum(0)
    grad_value = grad_value + grad_y[4] * (curvature * z[4] + third * along.square())
    grad_first = grad_first + (2 * grad_y[4] * curvature * along) * v
    return torch.cat([grad_value.unsqueeze(0), grad_first, (grad_y[4] * slope).unsqueeze(0)], 0)


if triton is not None:

    @triton.jit
    def forward_kernel(z, addend, directions, y, size, width, rows_of_addend, second: tl.constexpr, block: tl.constexpr):
        i = tl.program_id(0) * block + tl.arange(0, block)
        in_range = i < size
        row = i // width
        value = tl.load(z + i, mask=in_range, other=0.0)
        value += tl.load(addend + (row // rows_of_addend) * width + i % width, mask=in_range, other=0.0)
        z1 = tl.load(z + size + i, mask=in_range, other=0.0)
        z2 = tl.load(z + 2 * size + i, mask=in_range, other=0.0)
        z3 = tl.load(z + 3 * size + i, mask=in_range, other=0.0)
        s = 1 / (1 + tl.exp(-value))
        q = s * (1 - s)
        slope = s + value * q
        tl.store(y + i, value * s, mask=in_range)
        tl.store(y + size + i, slope * z1, mask=in_range)
        tl.store(y + 2 * size + i, slope * z2, mask=in_range)
        tl.store(y + 3 * size + i, slope * z3, mask=in_range)
        if second:
            z4 = tl.load(z + 4 * size + i, mask=in_range, other=0.0)
            along = z1 * tl.load(directions + 3 * row, mask=in_range, other=0.0)
            along += z2 * tl.load(directions + 3 * row + 1, mask=in_range, other=0.0)
            along += z3 * tl.load(directions + 3 * row + 2, mask=in_range, other=0.0)
            curvature = q * (2 + value * (1 - 2 * s))
            tl.store(y + 4 * size + i, slope * z4 + curvature * along * along, mask=in_range)

    @triton.jit
    def backward_kernel(z, addend, directions, grad_y, grad_z, size, width, rows_of_addend, second: tl.constexpr, block: tl.constexpr):
        i = tl.program_id(0) * block + tl.arange(0, block)
        in_range = i < size
        row = i // width
        value = tl.load(z + i, mask=in_range, other=0.0)
        value += tl.load(addend + (row // rows_of_addend) * width + i % width, mask=in_range, other=0.0)
        z1 = tl.load(z + size + i, mask=in_range, other=0.0)
        z2 = tl.load(z + 2 * size + i, mask=in_range, other=0.0)
        z3 = tl.load(z + 3 * size + i, mask=in_range, other=0.0)
        g0 = tl.load(grad_y + i, mask=in_range, other=0.0)
        g1 = tl.load(grad_y + size + i, mask=in_range, other=0.0)
        g2 = tl.load(grad_y + 2 * size + i, mask=in_range, other=0.0)
        g3 = tl.load(grad_y + 3 * size + i, mask=in_range, other=0.0)
        s = 1 / (1 + tl.exp(-value))
        q = s * (1 - s)
        h = 1 - 2 * s
        slope = s + value * q
        curvature = q * (2 + value * h)
        grad0 = g0 * slope + curvature * (g1 * z1 + g2 * z2 + g3 * z3)
        grad1 = g1 * slope
        grad2 = g2 * slope
        grad3 = g3 * slope
        if second:
            z4 = tl.load(z + 4 * size + i, mask=in_range, other=0.0)
            g4 = tl.load(grad_y + 4 * size + i, mask=in_range, other=0.0)
            v1 = tl.load(directions + 3 * row, mask=in_range, other=0.0)
            v2 = tl.load(directions + 3 * row + 1, mask=in_range, other=0.0)
            v3 = tl.load(directions + 3 * row + 2, mask=in_range, other=0.0)
            along = z1 * v1 + z2 * v2 + z3 * v3
            third = q * (3 * h + value * (h * h - 2 * q))
            grad0 += g4 * (curvature * z4 + third * along * along)
            directional_term = 2 * g4 * curvature * along
            grad1 += directional_term * v1
            grad2 += directional_term * v2
            grad3 += directional_term * v3
            tl.store(grad_z + 4 * size + i, g4 * slope, mask=in_range)
        tl.store(grad_z + i, grad0, mask=in_range)
        tl.store(grad_z + size + i, grad1, mask=in_range)
        tl.store(grad_z + 2 * size + i, grad2, mask=in_range)
        tl.store(grad_z + 3 * size + i, grad3, mask=in_range)

    def forward_by_kernel(z: Tensor, addend: Tensor, directions: Tensor, rows_of_addend: int) -> Tensor:
        y = torch.empty_like(z)
        size = z[0].numel()
        grid = (triton.cdiv(size, BLOCK),)
        forward_kernel[grid](z, addend, directions, y, size, z.shape[2], rows_of_addend, z.shape[0] > 4, BLOCK)
        return y

    def backward_by_kernel(z: Tensor, addend: Tensor, directions: Tensor, rows_of_addend: int, grad_y: Tensor) -> Tensor:
        grad_z = torch.empty_like(z)
        size = z[0].numel()
        grid = (triton.cdiv(size, BLOCK),)
        backward_kernel[grid](z, addend, directions, grad_y, grad_z, size, z.shape[2], rows_of_addend, z.shape[0] > 4, BLOCK)
        return grad_z

else:
    forward_by_kernel, backward_by_kernel = forward_plain, backward_plain


def kernels_agree(device: torch.device) -> bool:
    """Whether the kernels can be built and agree with PyTorch's operations on random numbers."""
    if not use_kernels:
        return False
    try:
        return max_relative_difference(device) < 1e-5
    except Exception as error:  # many kinds are possible: no compiler, an unknown device, another version of Triton
        print(f"Triton's kernels cannot be built: {error}")
        return False


def max_relative_difference(device: torch.device) -> float:
    """The largest difference between the kernels' and PyTorch's numbers, relative to the largest number."""
    differences = []
    with torch.random.fork_rng(devices=[device]):
        for channels in (4, 5):
            z = 2 * torch.randn(channels, 21, 48, device=device)
            grad_y = torch.randn_like(z)
            addend = torch.randn(3, 48, device=device)
            v = torch.randn(21, 3, device=device)
            pairs = [
                (forward_by_kernel(z, addend, v, 7), forward_plain(z, addend, v, 7)),
                (backward_by_kernel(z, addend, v, 7, grad_y), backward_plain(z, addend, v, 7, grad_y)),
            ]
            differences += [float((a - b).abs().max() / b.abs().max()) for a, b in pairs]
    return max(differences)
