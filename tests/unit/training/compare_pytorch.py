"""Compares the PyTorch trainer with what training_set_test.cpp wrote: compare_pytorch.py SET REFERENCE TRAINED.

Exits with 1, and says what differs, if answers, the loss or its gradient differ by more than 1e-5 of their size.
Writes the set's network as a trained one.
"""

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "engine" / "training" / "pytorch"))
sys.dont_write_bytecode = True

import torch  # noqa: E402

import training_set  # noqa: E402
from batches import STRAIN  # noqa: E402
from network import response  # noqa: E402
from trainer import Training  # noqa: E402

TOLERANCE = 1e-5


def main() -> int:
    torch.set_num_threads(1)
    data = training_set.read(Path(sys.argv[1]))
    with h5py.File(sys.argv[2], "r") as file, ThreadPoolExecutor(1) as workers:
        training = Training(data, torch.device("cpu"), 0, workers)
        batches = training.batches
        symmetry = torch.from_numpy(file["symmetry"][:])
        batches.input_of[0] = symmetry * batches.designs + batches.chunk_design
        batches.row_of[0] = batches.rows[batches.positions] + symmetry.unsqueeze(1) * batches.row_count
        batches.mask_of[0] = batches.masks
        batches.unit_of[0] = torch.from_numpy(file["unit"][:].astype(np.float32)).reshape(batches.unit_of[0].shape)
        batches.next.zero_()
        batch = batches.batch()
        training.tangent_weight.fill_(training.full_tangent_weight)
        answer = response(training.shape, training.parameters(), batch.inputs, batch.rows[..., STRAIN], batch.directions)
        loss, gradients = training.loss_and_gradients(batch)
        by_place = dict(zip(map(id, training.optimizer.leaves), gradients))
        pairs = {name: (getattr(answer, name), file[name][:]) for name in ("energy", "stress", "along")}
        pairs["loss"] = (loss, np.array(file["loss"][()]))
        matrices, others = iter(training.optimizer.matrix_leaves), iter(training.optimizer.other_leaves)
        for place, tensor in enumerate(data.network):
            if place == training.shape.trunk:
                made = torch.cat([by_place[id(next(matrices))], by_place[id(next(matrices))]], 1)
            else:
                made = by_place[id(next(matrices if training.is_matrix(place, torch.from_numpy(tensor)) else others))]
            name = f"gradient/{place}"
            pairs[name] = (made, file[name][:] if name in file else np.zeros(tensor.size))
    different = []
    for name, (ours, theirs) in pairs.items():
        mine = ours.detach().double().numpy().reshape(-1)
        away = np.linalg.norm(mine - theirs.reshape(-1))
        size = np.linalg.norm(theirs)
        print(f"{name}: {away:.3g} of {size:.3g}")
        if away > TOLERANCE * size:
            different.append(name)
    training_set.write_trained(Path(sys.argv[3]), data, training.network(), {"epochs": "0"}, 0)
    print("different: " + ", ".join(different) if different else "all agree")
    return 1 if different else 0


if __name__ == "__main__":
    raise SystemExit(main())
