"""Jets of the swish function f(z) = z sigmoid(z), with a gradient of their own: one pass forward and one backward.

On a GPU each pass is one kernel, written in Triton. Elsewhere, and where there is no Triton, PyTorch's operations do the
same. Channels are the value, three derivatives and, if there are five, the second derivative along a direction.
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

# Whether GPUs use the kernels; a trainer that finds them wrong switches them off.
use_kernels = triton is not None
BLOCK = 1024


def jets(z: Tensor, addend: Tensor, directions: Tensor, rows_of_addend: int) -> Tensor:
    """The jets of f(z + addend): z is channels x rows x width, directions are rows x 3.

    Each row of `addend` is added to the values of the next `rows_of_addend` rows.
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
    def backward(context: Any, g: Tensor) -> tuple[Tensor | None, ...]:
        z, addend, directions = context.saved_tensors
        pass_back = backward_by_kernel if z.is_cuda and use_kernels else backward_plain
        by_z = pass_back(z.contiguous(), addend.contiguous(), directions, context.rows_of_addend, g.contiguous())
        return by_z, by_z[0].reshape(addend.shape[0], -1, addend.shape[1]).sum(1), None, None


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


def backward_plain(z: Tensor, addend: Tensor, directions: Tensor, rows_of_addend: int, g: Tensor) -> Tensor:
    value = values_of(z, addend, rows_of_addend)
    s = torch.sigmoid(value)
    q = s * (1 - s)
    h = 1 - 2 * s
    slope = s + value * q
    curvature = q * (2 + value * h)
    by_value = g[0] * slope + curvature * (g[1:4] * z[1:4]).sum(0)
    by_first = g[1:4] * slope
    if z.shape[0] == 4:
        return torch.cat([by_value.unsqueeze(0), by_first], 0)
    third = q * (3 * h + value * (h * h - 2 * q))
    v = directions.t().unsqueeze(2)
    along = (z[1:4] * v).sum(0)
    by_value = by_value + g[4] * (curvature * z[4] + third * along.square())
    by_first = by_first + (2 * g[4] * curvature * along) * v
    return torch.cat([by_value.unsqueeze(0), by_first, (g[4] * slope).unsqueeze(0)], 0)


if triton is not None:

    @triton.jit
    def forward_kernel(z, addend, directions, y, size, width, rows_of_addend, second: tl.constexpr, block: tl.constexpr):
        i = tl.program_id(0) * block + tl.arange(0, block)
        inside = i < size
        row = i // width
        value = tl.load(z + i, mask=inside, other=0.0)
        value += tl.load(addend + (row // rows_of_addend) * width + i % width, mask=inside, other=0.0)
        z1 = tl.load(z + size + i, mask=inside, other=0.0)
        z2 = tl.load(z + 2 * size + i, mask=inside, other=0.0)
        z3 = tl.load(z + 3 * size + i, mask=inside, other=0.0)
        s = 1 / (1 + tl.exp(-value))
        q = s * (1 - s)
        slope = s + value * q
        tl.store(y + i, value * s, mask=inside)
        tl.store(y + size + i, slope * z1, mask=inside)
        tl.store(y + 2 * size + i, slope * z2, mask=inside)
        tl.store(y + 3 * size + i, slope * z3, mask=inside)
        if second:
            z4 = tl.load(z + 4 * size + i, mask=inside, other=0.0)
            along = z1 * tl.load(directions + 3 * row, mask=inside, other=0.0)
            along += z2 * tl.load(directions + 3 * row + 1, mask=inside, other=0.0)
            along += z3 * tl.load(directions + 3 * row + 2, mask=inside, other=0.0)
            curvature = q * (2 + value * (1 - 2 * s))
            tl.store(y + 4 * size + i, slope * z4 + curvature * along * along, mask=inside)

    @triton.jit
    def backward_kernel(z, addend, directions, g, by, size, width, rows_of_addend, second: tl.constexpr, block: tl.constexpr):
        i = tl.program_id(0) * block + tl.arange(0, block)
        inside = i < size
        row = i // width
        value = tl.load(z + i, mask=inside, other=0.0)
        value += tl.load(addend + (row // rows_of_addend) * width + i % width, mask=inside, other=0.0)
        z1 = tl.load(z + size + i, mask=inside, other=0.0)
        z2 = tl.load(z + 2 * size + i, mask=inside, other=0.0)
        z3 = tl.load(z + 3 * size + i, mask=inside, other=0.0)
        g0 = tl.load(g + i, mask=inside, other=0.0)
        g1 = tl.load(g + size + i, mask=inside, other=0.0)
        g2 = tl.load(g + 2 * size + i, mask=inside, other=0.0)
        g3 = tl.load(g + 3 * size + i, mask=inside, other=0.0)
        s = 1 / (1 + tl.exp(-value))
        q = s * (1 - s)
        h = 1 - 2 * s
        slope = s + value * q
        curvature = q * (2 + value * h)
        by0 = g0 * slope + curvature * (g1 * z1 + g2 * z2 + g3 * z3)
        by1 = g1 * slope
        by2 = g2 * slope
        by3 = g3 * slope
        if second:
            z4 = tl.load(z + 4 * size + i, mask=inside, other=0.0)
            g4 = tl.load(g + 4 * size + i, mask=inside, other=0.0)
            v1 = tl.load(directions + 3 * row, mask=inside, other=0.0)
            v2 = tl.load(directions + 3 * row + 1, mask=inside, other=0.0)
            v3 = tl.load(directions + 3 * row + 2, mask=inside, other=0.0)
            along = z1 * v1 + z2 * v2 + z3 * v3
            third = q * (3 * h + value * (h * h - 2 * q))
            by0 += g4 * (curvature * z4 + third * along * along)
            bend = 2 * g4 * curvature * along
            by1 += bend * v1
            by2 += bend * v2
            by3 += bend * v3
            tl.store(by + 4 * size + i, g4 * slope, mask=inside)
        tl.store(by + i, by0, mask=inside)
        tl.store(by + size + i, by1, mask=inside)
        tl.store(by + 2 * size + i, by2, mask=inside)
        tl.store(by + 3 * size + i, by3, mask=inside)

    def forward_by_kernel(z: Tensor, addend: Tensor, directions: Tensor, rows_of_addend: int) -> Tensor:
        y = torch.empty_like(z)
        size = z[0].numel()
        grid = (triton.cdiv(size, BLOCK),)
        forward_kernel[grid](z, addend, directions, y, size, z.shape[2], rows_of_addend, z.shape[0] > 4, BLOCK)
        return y

    def backward_by_kernel(z: Tensor, addend: Tensor, directions: Tensor, rows_of_addend: int, g: Tensor) -> Tensor:
        by = torch.empty_like(z)
        size = z[0].numel()
        grid = (triton.cdiv(size, BLOCK),)
        backward_kernel[grid](z, addend, directions, g, by, size, z.shape[2], rows_of_addend, z.shape[0] > 4, BLOCK)
        return by

else:
    forward_by_kernel, backward_by_kernel = forward_plain, backward_plain


def kernels_agree(device: torch.device) -> bool:
    """Whether the kernels can be built and give what PyTorch's operations give, on drawn numbers."""
    if not use_kernels:
        return False
    try:
        return largest_difference(device) < 1e-5
    except Exception as error:  # of many kinds: no compiler, an unknown device, another version of Triton
        print(f"Triton's kernels cannot be built: {error}")
        return False


def largest_difference(device: torch.device) -> float:
    """Of a kernel's number from PyTorch's, as a share of the largest number."""
    differences = []
    with torch.random.fork_rng(devices=[device]):
        for channels in (4, 5):
            z = 2 * torch.randn(channels, 21, 48, device=device)
            g = torch.randn_like(z)
            addend = torch.randn(3, 48, device=device)
            v = torch.randn(21, 3, device=device)
            pairs = [
                (forward_by_kernel(z, addend, v, 7), forward_plain(z, addend, v, 7)),
                (backward_by_kernel(z, addend, v, 7, g), backward_plain(z, addend, v, 7, g)),
            ]
            differences += [float((a - b).abs().max() / b.abs().max()) for a, b in pairs]
    return max(differences)
