"""Files on their way to a worker."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from gcodesim.scale.bundle import FORM, BundleError, FileBundle


def test_what_is_packed_comes_back_and_equal_bundles_are_equal_bytes(tmp_path: Path):
    bundle = FileBundle(files={"b/c.stl": b"\x00\xff", "a.nc": b"M2\n"}, said={"n": 1.5})

    again = FileBundle.unpack(bundle.pack())
    again.write(tmp_path)

    assert again == bundle
    assert (tmp_path / "b" / "c.stl").read_bytes() == b"\x00\xff"
    assert FileBundle(files=dict(reversed(bundle.files.items())), said={"n": 1.5}).pack() == bundle.pack()


def test_a_pickle_is_no_bundle_and_is_not_run():
    class Bomb:
        def __reduce__(self):
            return pytest.fail, ("a stranger's bytes were unpickled",)

    for data in (pickle.dumps(Bomb()), FORM + pickle.dumps(Bomb()), b"", b"gcodesim"):
        with pytest.raises(BundleError):
            FileBundle.unpack(data)


@pytest.mark.parametrize("name", ["../a", "/etc/a", "a/../../b", "", "a\0"])
def test_no_name_leads_out_of_the_folder(name: str):
    with pytest.raises(BundleError):
        FileBundle.unpack(FileBundle(files={name: b""}).pack())


@pytest.mark.parametrize("name", ["a\\b", "c:a"])
def test_what_leads_out_on_some_systems_is_a_name_on_others(name: str, monkeypatch: pytest.MonkeyPatch):
    data = FileBundle(files={name: b""}).pack()
    monkeypatch.setattr("gcodesim.scale.bundle._LEADING_OUT", "")
    assert set(FileBundle.unpack(data).files) == {name}
    monkeypatch.setattr("gcodesim.scale.bundle._LEADING_OUT", "\\:")
    with pytest.raises(BundleError):
        FileBundle.unpack(data)


def test_names_of_all_kinds_travel(tmp_path: Path):
    """What a file may be called on this system, also in bytes that are no UTF-8."""
    files = {"12:30.nc": b"M2\n", "x\n::y\x1b.nc": b"", "caf\udce9.nc": b"M30\n"}
    FileBundle.unpack(FileBundle(files=files).pack()).write(tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == files


def test_bytes_that_are_cut_off_or_too_many_are_refused():
    data = FileBundle(files={"a": b"12345"}).pack()

    for bad in (data[:-1], data + b"x", data[: len(FORM) + 20]):
        with pytest.raises(BundleError):
            FileBundle.unpack(bad)
