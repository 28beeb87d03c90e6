"""Names of files that somebody else chose, as hooks and patterns of a shell put them on the command line."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.mark.parametrize("name", ["--write-baseline=x.nc", "-h", "--fail-on=never", "-o.nc"])
def test_a_file_name_is_no_option(cli, write, tmp_path: Path, name: str) -> None:
    write(name, "G21\nG1 X1\nM2\n")  # feeds without F
    before = sorted(os.listdir())
    for command in (("lint",), ("check", "--cell", "cell.yaml")):
        done = cli(*command, "slot.nc", name)
        assert done.status == 2 and f"write ./{name}" in done.err
        assert cli(*command, f"./{name}").status == 1
        assert cli(*command, "--", name).status == 1
    assert sorted(os.listdir()) == before


@pytest.mark.parametrize("name", ["caf\udce9", "12:30", "x\n::stop-commands::y", "=1+1"])
def test_any_name_can_be_tested(cli, write, tmp_path: Path, name: str) -> None:
    """Also one in an old code page, which is no UTF-8; the second time what passed is known."""
    os.rename("slot.nc", f"{name}.nc")
    write(f"{name}.test.yaml", "cell: cell.yaml\n")
    assert cli("accept", ".").status == 0
    for _ in range(2):
        done = cli("test", ".")
        assert done.status == 0 and "1 passed" in done.out


def test_a_pipe_is_no_file_of_a_cell(cli, write, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.tbl")
    os.mkfifo(tmp_path / "pipe.stl")
    write("pipe.yaml", "gcodesim: 1\nmachine: gantry_xyz\ntool_table: pipe.tbl\nstock: {mesh: pipe.stl, unit: mm}\n")
    done = cli("cell", "validate", "pipe.yaml")
    assert done.status == 1 and done.out.count("is a pipe or a device") == 2


def test_a_mesh_of_a_robot_has_a_greatest_size(cli, write, tmp_path: Path) -> None:
    with (tmp_path / "big.stl").open("wb") as file:
        file.truncate(3 << 30)
    body = '<visual><geometry><mesh filename="big.stl"/></geometry></visual>'
    limit = '<limit lower="0" upper="1" velocity="1" effort="1"/>'
    write(
        "r.urdf",
        f'<robot name="r"><link name="a">{body}</link><link name="b"/><joint name="j" type="prismatic">'
        f'<parent link="a"/><child link="b"/>{limit}</joint></robot>',
    )
    write("robot.yaml", "gcodesim: 1\nrobots: {arm: {urdf: r.urdf}}\n")
    done = cli("cell", "validate", "robot.yaml")
    assert done.status == 1 and "GS714" in done.out and "2 GB" in done.out
