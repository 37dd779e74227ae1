"""Measured curves and parts by the command line client and the Python package, against a real server."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import supple
from harness import CLI, Api



def stress(strain: Any) -> Any:
    return 0.02 * strain + 0.002 * (np.exp(18 * strain) - 1)


def table(rows: int = 500) -> str:
    strain = np.linspace(0, 0.15, rows)
    lines = "\n".join(f"{100 * e:.4f};{1000 * s:.5f}".replace(".", ",") for e, s in zip(strain, stress(strain)))
    return f"Strain [%];Stress [kPa]\n{lines}\n"


def cli(api: Api, *arguments: str, text: str = "") -> "subprocess.CompletedProcess[str]":
    return subprocess.run([str(CLI), "--server", api.server.url, *arguments], input=text, capture_output=True, text=True, timeout=60)


def test_the_command_line_reduces_a_curve_and_designs_for_it(designs: Api, tmp_path: Path) -> None:
    file = tmp_path / "tensile.csv"
    file.write_text(table())
    shown = cli(designs, "curve", str(file), "--out", str(tmp_path / "target.csv"))
    assert shown.returncode == 0, shown.stderr
    assert "control points follow 500 measured ones" in shown.stdout
    points = np.loadtxt(tmp_path / "target.csv", delimiter=",")
    assert points[0].tolist() == [0, 0] and points[-1] == pytest.approx([0.15, stress(0.15)], rel=0.01)
    for arguments, text in (((str(file),), ""), (("-",), table())):
        found = cli(designs, "design", "--task", "stress_strain", "--family", "IH67", "--target", *arguments, "--starts", "2", text=text)
        assert found.returncode == 0, found.stderr
        assert "control points follow 500 measured ones" in found.stderr
    few = cli(designs, "curve", str(file), "--control-points", "3", "--units", "%,MPa")
    assert few.returncode == 0 and "3 control points" in few.stdout


def test_the_command_line_names_what_the_specimen_lacks(designs: Api, tmp_path: Path) -> None:
    file = tmp_path / "forces.csv"
    file.write_text("Extension (mm),Load (N)\n0,0\n1,2\n2,5\n")
    refused = cli(designs, "curve", str(file))
    assert refused.returncode != 0 and "gauge" in refused.stderr
    assert cli(designs, "curve", str(file), "--gauge-length", "50", "--area", "20").returncode == 0
    wrong = cli(designs, "curve", str(file), "--columns", "Extension")
    assert wrong.returncode == 1 and "--columns" in wrong.stderr


def test_the_command_line_makes_a_part(designs: Api, tmp_path: Path) -> None:
    files = {kind: tmp_path / f"part.{kind}" for kind in ("step", "stl", "3mf", "dxf", "svg")}
    options = [word for kind, file in files.items() for word in (f"--{kind}", str(file))]
    made = cli(designs, "part", "IH21", "--coupon", "12x30", "--grip", "8", "--thickness", "2", *options)
    assert made.returncode == 0, made.stderr
    assert "12 x 46 x 2 mm" in made.stdout
    assert files["stl"].read_bytes().startswith(b"Supple part, 12 x 46 x 2 mm") and files["3mf"].read_bytes().startswith(b"PK")
    assert files["step"].read_text().startswith("ISO-10303-21;")
    assert "LWPOLYLINE" in files["dxf"].read_text() and "<svg" in files["svg"].read_text()
    for arguments in (("IH21",), ("--coupon", "12x30"), ("IH21", "--coupon", "12")):
        assert cli(designs, "part", *arguments).returncode == 1


def test_python_reads_curves_and_makes_parts(designs: Api, tmp_path: Path) -> None:
    with supple.Client(designs.server.url) as client:
        file = tmp_path / "tensile.csv"
        file.write_text(table())
        curve = client.measured_curve(file)
        assert curve.point_count == 500 and curve.relative_rms <= 0.005 and curve.units == ("%", "kPa")
        target = supple.Target.from_csv(file, client)
        assert target.strain_measure == "engineering" and np.array_equal(target.control_points, curve.control_points)
        strain = np.linspace(0, 0.15, 80)
        same = supple.Target.from_xy(strain, stress(strain), client, max_control_points=6)
        assert len(same.control_points) <= 6
        result = client.design(target, family="IH67", options=supple.DesignOptions(candidates=24, starts=2))
        outline = supple.parts.coupon(12, 30, 8)
        options = supple.PartOptions(thickness=2, density=1.1, frame=0.5)
        part = client.part(outline, result.family, result.parameters, options=options)
        assert part.size == pytest.approx((12, 46, 2)) and part.mass == pytest.approx(1.1e-3 * part.volume)
        assert client.part_file(outline, result.family, result.parameters, kind="3mf", options=options).startswith(b"PK")
        with pytest.raises(ValueError, match="either source or points"):
            client.measured_curve()
        with pytest.raises(ValueError, match="kind"):
            client.part_file(outline, "IH21", kind="obj")
        region = supple.PartRegion([[0, 0], [6, 0], [6, 46], [0, 46]], "IH29", beam_width=0.4)
        two = client.part(outline, "IH67", options=supple.PartOptions(regions=[region]))
        assert two.crumbs == 0 and two.size == pytest.approx((12, 46, 1))
