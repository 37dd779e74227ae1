#!/usr/bin/env python3
"""Trains the networks of training sets, several at a time on one GPU, for a given time.

    supple-lab train --data D.h5 --width 192 --batch-chunks 64 ... --out m.h5 --export m-set.h5
    python3 train.py m-set.h5 --out-folder trained --seconds 480
    supple-lab train --data D.h5 --width 192 --batch-chunks 64 ... --out m.h5 --import trained/m-set.h5

All options of a training but its length are those of the set. A run goes on for `--seconds`, over which the rate falls.
"""

from __future__ import annotations

import argparse
import os
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Many threads compute eigenvectors, each of one matrix. Threads of the BLAS library would compete with them.
for variable in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import torch  # noqa: E402

import activation  # noqa: E402
import training_set  # noqa: E402
from trainer import Training  # noqa: E402


def device_of(name: str) -> torch.device:
    if name == "automatic":
        name = "cuda" if torch.cuda.is_available() else "cpu"
    return torch.device(name)


def train_all(trainings: dict[str, Training], out_folder: Path, interval: float) -> list[str]:
    """Runs trainings, which are given by name, in parallel. Returns a message for each that failed."""
    failures: list[str] = []

    def run(name: str, training: Training) -> None:
        try:
            training.run(out_folder / name, lambda line: print(f"{name}: {line}", flush=True), interval)
        except Exception as error:  # the other trainings continue
            failures.append(f"{name}: {error}")
            print(failures[-1], flush=True)

    threads = [threading.Thread(target=run, args=item) for item in trainings.items()]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return failures


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sets", nargs="+", type=Path, help="files of supple-lab train --export")
    parser.add_argument("--out-folder", type=Path, required=True, help="gets a trained network of each set's name")
    parser.add_argument("--seconds", type=float, required=True, help="that each training takes")
    parser.add_argument("--device", default="automatic", help="automatic, cuda or cpu")
    parser.add_argument("--interval", type=float, default=30, help="seconds between reports; each also saves the network")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="threads that find eigenvectors")
    arguments = parser.parse_args()
    device = device_of(arguments.device)
    if device.type == "cuda" and not activation.kernels_agree(device):
        print("the kernels are not used: they are missing, or give other numbers", flush=True)
        activation.use_kernels = False
    if len({path.name for path in arguments.sets}) < len(arguments.sets):
        parser.error("two sets have one name, which their trained networks would share")
    arguments.out_folder.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(arguments.workers) as workers:
        trainings = {path.name: Training(training_set.read(path), device, arguments.seconds, workers) for path in arguments.sets}
        for name, training in trainings.items():
            training.prepare()
            print(f"{name}: {training.batches.chunks} chunks, {training.batches.steps} steps to a shuffle, on {device}", flush=True)
        return 1 if train_all(trainings, arguments.out_folder, arguments.interval) else 0


if __name__ == "__main__":
    raise SystemExit(main())
