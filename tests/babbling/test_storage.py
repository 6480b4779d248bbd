"""Strangers' forward models: whatever is wrong with the file, one line says so, and nothing is run or run out of."""

import os
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from babbling.errors import BabblingError
from babbling.storage import LARGEST_BYTES, VERSION, check_kind, load_mind, save_mind


@pytest.fixture
def file(arm_mind, tmp_path: Path) -> Path:
    path = tmp_path / "arm.nc"
    save_mind(arm_mind, path)
    return path


def attribute(name: str, value: object) -> Callable[[h5py.File], None]:
    return lambda f: f.attrs.__setitem__(name, value)


def drop(name: str) -> Callable[[h5py.File], None]:
    return lambda f: f.__delitem__(name)


def fill(name: str, value: float) -> Callable[[h5py.File], None]:
    return lambda f: f[name].__setitem__(..., value)


def widen(name: str) -> Callable[[h5py.File], None]:
    def spoil(f: h5py.File) -> None:
        del f[name]
        f.create_dataset(name, data=np.ones((3, 3, 3, 3)))
        scale = f["factor"]
        for i in range(4):
            f[name].dims[i].attach_scale(scale)

    return spoil


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (attribute("version", VERSION + 1), f"written in version {VERSION + 1}, this program reads up to {VERSION}"),
        (attribute("version", "new"), "written in version new"),
        (attribute("format", "something else"), "not a file of kind"),
        (attribute("unit", 7), "do not fit together"),
        (drop("counts"), "do not fit together"),
        (drop("schema_posture"), "do not fit together"),
        (fill("counts", -1), "non-negative"),
        (fill("schema_posture", 99), "a sense line that does not exist"),
        (fill("coasting", np.nan), "finite numbers"),
        (fill("dynamics_noise", np.inf), "finite numbers"),
        (fill("schema_slope", 0.0), "a motor that does nothing"),
        (fill("moments", 0), "next to no experience"),
        (widen("coasting"), "'coasting' is not 3 rows"),
        (widen("dynamics_control"), "'dynamics_control' is not 3 rows"),
        (fill("rate_high", -1e9), "low must lie below high"),
    ],
)
def test_spoiled_minds(file: Path, spoil: Callable[[h5py.File], None], message: str) -> None:
    with h5py.File(file, "r+") as f:
        spoil(f)
    with pytest.raises(BabblingError, match=message) as caught:
        load_mind(file)
    assert str(file) in str(caught.value) and "\n" not in str(caught.value)


def test_cut_files(file: Path) -> None:
    content = file.read_bytes()
    for share in (0.0, 0.1, 0.5, 0.9, 0.999):
        file.write_bytes(content[: int(share * len(content))])
        with pytest.raises(BabblingError, match=r"arm\.nc: .*make it anew"):
            load_mind(file)


def test_flipped_bytes_give_a_mind_or_one_line(file: Path) -> None:
    content, rng = bytearray(file.read_bytes()), np.random.default_rng(0)
    for _ in range(8):
        spoiled = content.copy()
        for place in rng.integers(0, len(content), 20):
            spoiled[place] ^= int(rng.integers(1, 256))
        file.write_bytes(spoiled)
        try:
            mind, _ = load_mind(file)
        except BabblingError as fault:
            assert str(file) in str(fault)
        else:
            assert np.isfinite(mind.forward_model.predictive).all()


def test_no_file_a_directory_text_and_another_netcdf(tmp_path: Path) -> None:
    with pytest.raises(BabblingError, match="no such file"):
        load_mind(tmp_path / "none.nc")
    with pytest.raises(BabblingError, match="a directory"):
        load_mind(tmp_path)
    text = tmp_path / "text.nc"
    text.write_text("not a forward model\n")
    with pytest.raises(BabblingError, match="not a readable NetCDF-4 file"):
        load_mind(text)
    with pytest.raises(BabblingError, match="would be lost"):
        check_kind(text)
    other = tmp_path / "other.nc"
    with h5py.File(other, "w") as f:
        f["x"] = np.arange(3)
    with pytest.raises(BabblingError, match="not a file of kind"):
        load_mind(other)


def test_huge_files_are_refused_before_they_are_read(file: Path, tmp_path: Path) -> None:
    with open(tmp_path / "huge.nc", "wb") as f:
        os.truncate(f.fileno(), 10 << 30)
    assert (10 << 30) > LARGEST_BYTES
    with pytest.raises(BabblingError, match=r"10737418240 bytes; more than \d+ are not read"):
        load_mind(tmp_path / "huge.nc")
    with h5py.File(file, "r+") as f:  # small on disk, 80 GB once unpacked
        shape = (100, 1000, 100, 1000)
        f.create_dataset("zeros", shape, np.int64, chunks=(1, 1, 100, 1000), compression="gzip")
    assert file.stat().st_size < 1 << 20
    with pytest.raises(BabblingError, match="unpacks to 8"):
        load_mind(file)


def test_a_place_that_cannot_be_written_keeps_nothing_half_done(arm_mind, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BabblingError, match="cannot be written"):
        save_mind(arm_mind, tmp_path / "file" / "arm.nc")
    assert [p.name for p in tmp_path.iterdir()] == ["file"]
