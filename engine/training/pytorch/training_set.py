"""Files that supple-lab exchanges with another trainer: the training set and the trained network (docs/models.md).

`supple-lab train ... --export SET` writes the training set. `supple-lab train ... --import TRAINED` reads the trained
network, and must have the same other options.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

TRAINING, VALIDATION, TEST, ROW_TEST = range(4)


@dataclass
class TrainingSet:
    """Simulated states of designs, called rows and sorted by design, and the initial network.

    Strains are (E_xx, E_yy, 2 E_xy). Energies, stresses and tangents are in MPa.
    """

    options: dict[str, str]  # options of supple-lab train, and numbers that identify the rows
    parameters: int  # number of parameters of the family
    network: list[np.ndarray]  # weights and bias of each layer: strain branch, parameter branch, trunk, stiffness branch
    part_of_row: np.ndarray  # TRAINING, VALIDATION, TEST or ROW_TEST
    design_of_row: np.ndarray
    inputs: np.ndarray  # images of the designs under each symmetry, one symmetry after the other; x inputs of the network
    usable: np.ndarray  # designs x symmetries: 1 where the symmetry may be applied to the design
    strain: np.ndarray
    stress: np.ndarray
    energy: np.ndarray  # rows x 1
    tangent: np.ndarray  # rows x 6: 11, 12, 13, 22, 23, 33
    whitening: np.ndarray  # rows x 6: maps unit vectors to strains v with v^T C v = 1
    strain_maps: np.ndarray  # symmetries x 9: matrix by which each symmetry transforms strains; the first is the identity


def read(path: Path) -> TrainingSet:
    """Reads a training set. Raises ValueError if the file is none."""
    with h5py.File(path, "r") as file:
        if file.attrs.get("layout") != "supple training set" or file.attrs.get("version") != 1:
            raise ValueError(f"{path} is no training set, or one of another version")
        tables = ("part_of_row", "design_of_row", "inputs", "usable", "strain", "stress", "energy", "tangent", "whitening", "strain_maps")
        return TrainingSet(
            options=named(file["options"].asstr()[:]),
            parameters=int(file["parameters"][()]),
            network=read_tensors(file["network"]),
            **{name: file[name][:] for name in tables},
        )


def write_trained(path: Path, of: TrainingSet, network: Sequence[np.ndarray], training: Mapping[str, str], seconds: float) -> None:
    """Writes the trained network of a set, and how it was trained. The file appears completely or not at all."""
    unfinished = path.with_name(path.name + ".writing")
    text = h5py.string_dtype()
    with h5py.File(unfinished, "w", track_order=True) as file:
        file.attrs["layout"] = "supple trained network"
        file.attrs["version"] = 1
        file.create_dataset("options", data=lines(of.options), dtype=text)
        file.create_dataset("training", data=lines(training), dtype=text)
        file.create_dataset("seconds", data=float(seconds))
        group = file.create_group("network", track_order=True)
        for i, tensor in enumerate(network):
            group.create_dataset(str(i), data=tensor.reshape(-1, tensor.shape[1] if tensor.ndim == 2 else 1))
        kinds = [f"{i} {'matrix' if tensor.ndim == 2 else 'vector'}" for i, tensor in enumerate(network)]
        group.create_dataset("names", data=kinds, dtype=text)
    os.replace(unfinished, path)


def read_trained(path: Path) -> list[np.ndarray]:
    """Reads the network of a file that `write_trained` wrote."""
    with h5py.File(path, "r") as file:
        return read_tensors(file["network"])


def read_tensors(group: h5py.Group) -> list[np.ndarray]:
    kinds = [name.rsplit(" ", 1)[1] for name in group["names"].asstr()[:]]
    tensors = [group[str(i)][:].astype(np.float32) for i in range(len(kinds))]
    return [tensor if kind == "matrix" else tensor.reshape(-1) for tensor, kind in zip(tensors, kinds)]


def lines(options: Mapping[str, str]) -> list[str]:
    return [f"{name}={value}" for name, value in options.items()]


def named(texts: Sequence[str]) -> dict[str, str]:
    return dict(text.split("=", 1) for text in texts)
