"""Measured curves and parts with the command line client and the Python package, and a real server."""

from __future__ import annotations

import json
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
    points = np.loadtxt(tmp_path / "target.csv", delimiter=",", skiprows=1)
    assert points[0].tolist() == [0, 0] and points[-1] == pytest.approx([0.15, stress(0.15)], rel=0.01)
    for arguments, text in (((str(file),), ""), (("-",), table())):
        found = cli(designs, "design", "--task", "stress_strain", "--family", "IH67", "--target", *arguments, "--starts", "2", "--missed-ok", text=text)
        assert found.returncode == 0, found.stderr
        assert "control points follow 500 measured ones" in found.stderr
    few = cli(designs, "curve", str(file), "--control-points", "3", "--units", "%,MPa")
    assert few.returncode == 0 and "3 control points" in few.stdout


# Measurements with units, of as few rows as control points have.
FEW = "Zeit [s];Dehnung [%];Spannung [kPa];Temp [°C]\n0;0;0;23\n1;5;21;23\n2;7,5;33;23\n3;10;50;23\n4;15;110;23\n"


def test_the_command_line_reads_every_encoding(designs: Api, tmp_path: Path) -> None:
    said = set()
    for encoding in ("utf-8", "utf-8-sig", "latin-1", "cp1252", "utf-16", "utf-16-le", "utf-16-be"):
        file = tmp_path / f"{encoding}.csv"
        file.write_bytes(FEW.encode(encoding))
        shown = cli(designs, "curve", str(file))
        assert shown.returncode == 0, shown.stderr
        assert "x in %, y in kPa" in shown.stdout and "tension was assumed" in shown.stderr
        said.add(shown.stdout)
    assert len(said) == 1
    chinese = tmp_path / "gbk.csv"
    chinese.write_bytes("时间(s),压缩应变(%),压缩应力(kPa)\n0,0,0\n1,5,21\n2,10,50\n".encode("gbk"))
    shown = cli(designs, "curve", str(chinese))
    assert shown.returncode == 0 and "titles speak of compression" in shown.stderr and "-0.1" in shown.stdout, shown.stderr


def test_a_design_reads_a_file_as_the_curve_does(designs: Api, tmp_path: Path) -> None:
    file = tmp_path / "few.csv"
    # Rows that could be control points are read as measurements, which are refused without units.
    for text, more in ((FEW, []), ("0,0\n5,21\n10,50\n15,110\n", ["--units", "%,kPa"])):
        file.write_text(text)
        curve = json.loads(cli(designs, "--json", "curve", str(file), *more).stdout)
        design = ["--json", "design", "--task", "stress_strain", "--family", "IH67", "--target", str(file), "--starts", "1", "--missed-ok"]
        found = cli(designs, *design, *more)
        assert found.returncode == 0, found.stderr
        profile = json.loads(found.stdout)["profile"]
        assert profile["x"][-1] == pytest.approx(0.15)
        assert profile["target"][-1] == pytest.approx(curve["target"]["control_points"][-1][1])
    refused = cli(designs, *design)
    assert refused.returncode == 2 and "--units" in refused.stderr
    # Control points have an option of their own.
    points = tmp_path / "points.csv"
    points.write_text("0,0\n0.1,0.05\n0.15,0.11\n")
    found = cli(designs, "--json", "design", "--task", "stress_strain", "--family", "IH67", "--target-points", str(points), "--starts", "1",
                "--missed-ok")
    assert found.returncode == 0 and json.loads(found.stdout)["profile"]["target"][-1] == pytest.approx(0.11), found.stderr
    both = cli(designs, "design", "--task", "stress_strain", "--target", "0,0;0.1,1", "--target-points", str(points))
    assert both.returncode == 1


def test_control_points_in_the_place_of_measurements_are_told_the_option_that_reads_them(designs: Api, tmp_path: Path) -> None:
    file = tmp_path / "points.csv"
    advice = f"give --target-points {file}"
    for task, points in (("stress_strain", "0,0\n0.1,0.05\n0.15,0.11\n"), ("poisson", "0,0.3\n45deg,-0.1\n"),
                         ("poisson", "0,0.3\n0.8,-0.1\n"), ("stiffness", "direction,stiffness\n0,1,1\n0.8,2,3\n"),
                         ("stress_strain", "x,y,weight,band\n0,0,1,0.1\n0.1,0.05,1,0.1\n")):
        file.write_text(points)
        refused = cli(designs, "design", "--task", task, "--family", "IH67", "--target", str(file))
        assert refused.returncode == 2 and advice in refused.stderr, refused.stderr
        piped = cli(designs, "design", "--task", task, "--family", "IH67", "--target", "-", text=points)
        assert piped.returncode == 2 and "give --target-points FILE" in piped.stderr, piped.stderr
    # A file that cannot be control points can only be measurements.
    file.write_text("Time,Load,Extension,Strain,Stress\n0,0,0,0,0\n1,2,3,4,5\n")
    refused = cli(designs, "design", "--task", "stress_strain", "--family", "IH67", "--target", str(file))
    assert refused.returncode == 2 and "--target-points" not in refused.stderr, refused.stderr
    # The fault of a control point names the option of the file.
    file.write_text("0,0\n0.1,0.05\n0.05,0.11\n")
    refused = cli(designs, "design", "--task", "stress_strain", "--family", "IH67", "--target-points", str(file))
    assert refused.returncode == 2 and "--target-points" in refused.stderr, refused.stderr
    with supple.Client(designs.server.url) as client, pytest.raises(supple.InvalidRequest, match=r"give them to supple\.Target"):
        supple.Target.from_csv(file, client)


def test_the_command_line_says_which_option_answers(designs: Api, tmp_path: Path) -> None:
    file = tmp_path / "file.csv"
    for text, options, answer in (
        ("Strain,Stress\n0,0\n5,21\n", ["--units"], ["--units", "%,kPa"]),
        ("Strain (%);Stress (kPa)\n1,234;2,345\n2,345;3,456\n", ["--decimal-separator"], ["--decimal-separator", "comma"]),
        ("Strain (%);Stress (kPa)\n0;0\n-5;21\n", ["--sense"], ["--sense", "compression"]),
        ("Position (mm),Load (N)\n120,0\n125,9\n", ["--gauge-length", "--area", "--zero"], ["--gauge-length", "50", "--area", "20", "--zero", "first"]),
        ("0,1,2\n1,2,3\n", ["--columns"], ["--columns", "0,2", "--units", "%,kPa"]),
        ("Strain (%),Stress (kPa)\n0,0\n5,21\n\n0,0\n5,18\n", [], ["--block", "1"]),
    ):
        file.write_text(text)
        refused = cli(designs, "curve", str(file))
        assert refused.returncode == (2 if options else 0), refused.stderr
        assert all(option in refused.stderr for option in options), refused.stderr
        read = cli(designs, "curve", str(file), *answer)
        assert read.returncode == 0, read.stderr
    assert "block 1 was read" in read.stderr


def test_points_set_aside_are_a_warning_in_colour(designs: Api, tmp_path: Path) -> None:
    file = tmp_path / "cycle.csv"
    file.write_text("Strain (%),Stress (kPa)\n" + "".join(f"{e},{9 * e}\n" for e in [*range(20), *range(18, 0, -1)]))
    shown = cli(designs, "curve", str(file))
    assert "Warning: 18 points were set aside: 18 that belong to no first loading" in shown.stderr and "\x1b" not in shown.stderr
    with supple.Client(designs.server.url) as client, pytest.warns(UserWarning, match="set aside"):
        assert client.measured_curve(file).set_aside_reasons == {"not_first_loading": 18}


def test_python_reads_what_machines_write(designs: Api, tmp_path: Path) -> None:
    with supple.Client(designs.server.url) as client:
        for encoding in ("utf-8", "cp1252", "utf-16"):
            file = tmp_path / f"{encoding}.csv"
            file.write_bytes(FEW.encode(encoding))
            curve = client.measured_curve(file)
            assert curve.units == ("%", "kPa") and curve.points[-1] == pytest.approx([0.15, 0.11])
            assert (curve.sense, curve.sense_told_by) == ("tension", "nothing") and curve.notes[0].pointer == "/sense"
        assert client.measured_curve(FEW, sense="compression").points[0] == pytest.approx([-0.15, -0.11])
        with pytest.raises(supple.InvalidRequest, match="units/y"):
            client.measured_curve("Strain (%),Stress\n0,0\n5,21\n")
        target = supple.Target.from_csv("Position (mm),Load (N)\n120,0\n125,20\n", client, gauge_length=50, area=20, zero="first")
        assert np.asarray(target.control_points)[-1] == pytest.approx([0.1, 1])
        assert client.measured_curve("1,234;2\n2,345;3\n", units=("%", "kPa"), decimal_separator="comma", origin="off").points[-1][0] == pytest.approx(0.02345)
        assert client.measured_curve("Strain %,Stress kPa\n0,0\n5,21\n\n0,0\n5,18\n", block=1, rupture="off").points[-1][1] == pytest.approx(0.018)


def test_the_command_line_names_what_the_specimen_lacks(designs: Api, tmp_path: Path) -> None:
    file = tmp_path / "forces.csv"
    file.write_text("Extension (mm),Load (N)\n0,0\n1,2\n2,5\n")
    refused = cli(designs, "curve", str(file))
    assert refused.returncode != 0 and "--gauge-length" in refused.stderr and "--area" in refused.stderr
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
