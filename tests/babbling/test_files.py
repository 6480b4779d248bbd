"""Strangers' minds: whatever is wrong with the file, one line says so, and nothing is run or run out of."""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from babbling.errors import BabblingError
from babbling.files import LARGEST_BYTES, VERSION, is_kind, load, save
from babbling.mind import Mind, Temper
from babbling.variables import LARGEST_PIECE


@pytest.fixture
def file(arm_mind: Mind, tmp_path: Path) -> Path:
    path = tmp_path / "arm.nc"
    save(arm_mind, path, {"motor": ("shoulder", "elbow", "wrist")}, robot="arm")
    return path


def test_people_can_read_it(file: Path, arm_mind: Mind) -> None:
    model = arm_mind.forward_model.table
    with xr.open_dataset(file, engine="h5netcdf") as data:
        assert data["motor_name"].values.tolist() == ["shoulder", "elbow", "wrist"]
        assert data.attrs["robot"] == "arm"
        visits, probability = data["forward_model_table_counts"], data["forward_model_table_probability"]
        assert visits.dims == probability.dims == ("motor", "rate", "effort", "departure")
        np.testing.assert_array_equal(visits.values, model.counts / model.unit)
        np.testing.assert_allclose(probability.values, model.predictive, rtol=1e-6, atol=5.1e-7)
        for axis in model.axes:
            np.testing.assert_array_equal(probability[f"{axis.name}_points"].values, axis.points)
            assert data[f"{axis.name}_points"].attrs["units"] == axis.unit
        assert data["pilot_dynamics_coasting"].attrs["units"] == "s"
        assert data.sizes["state"] == 3
        for name in data.variables:
            assert str(name).isidentifier() and len(str(name)) < 64  # as MATLAB wants them


def attribute(name: str, value: object) -> Callable[[h5py.File], None]:
    return lambda f: f.attrs.__setitem__(name, value)


def fill(name: str, value: float) -> Callable[[h5py.File], None]:
    return lambda f: f[name].__setitem__(..., value)


def instead(name: str, value: object) -> Callable[[h5py.File], None]:
    def spoil(f: h5py.File) -> None:
        del f[name]
        f[name] = value

    return spoil


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (attribute("version", VERSION + 1), f"written in version {VERSION + 1}, this program reads up to {VERSION}"),
        (attribute("version", "new"), "written in version new"),
        (attribute("version", -5), "written in version -5"),
        (attribute("version", np.arange(9)), "written in version None"),
        (attribute("version", VERSION - 1), "written by an earlier version of this program; make one with `imitate b"),
        (attribute("format", "something else"), "not a file of kind 'imitation-laboratory mind'"),
        (fill("forward_model_table_counts", -1), "forward_model_table_counts holds -1; 0 to"),
        (fill("forward_model_table_counts", 1), "do not tell of the same experience"),
        (fill("forward_model_table_moments", 0), "do not tell of the same experience"),
        (fill("forward_model_table_prior_strength", np.nan), "prior_strength holds nan; 0 to"),
        (fill("pilot_schema_posture", 99), "pilot_schema_posture holds 99; sense has 0 to 5"),
        (fill("pilot_schema_slope", 0.0), "pilot_schema_slope holds 0; .* other than 0 is possible"),
        (fill("pilot_motors_rest", np.nan), "pilot_motors_rest holds nan"),
        (fill("pilot_minutes", -1), "pilot_minutes holds -1; 0 to"),
        (fill("pilot_dynamics_control", 1e308), r"pilot_dynamics_control holds 1e\+308; -10000 to 10000"),
        (fill("pilot_dynamics_noise", np.arange(27.0).reshape(3, 3, 3)), "pilot_dynamics_noise .* no covariance"),
        (fill("temper_eagerness", 1e308), r"temper_eagerness holds 1e\+308; 0 to 2 other than 0 is possible"),
        (fill("rate_points", np.zeros((3, 15))), "axis 'rate': factor 0 has no extent"),
        (fill("rate_points", np.arange(45.0).reshape(3, 15) ** 2), "rate_points are not evenly spaced"),
        (
            instead("pilot_motors_rest", np.zeros((2, 3))),
            r"pilot_motors_rest has shape \(2, 3\); \(3,\) is needed \(motor\)",
        ),
        (instead("pilot_motors_rest", np.zeros(3, "f4")), "missing, or not of type float64, .* make it anew"),
        (instead("pilot_motors_rest", h5py.SoftLink("/temper_trust")), "pilot_motors_rest is missing"),
        (instead("pilot_motors_rest", h5py.ExternalLink("/dev/zero", "/x")), "pilot_motors_rest is missing"),
        (instead("forward_model_table_axes", np.array([[b"/"], [b"a"]])), "2 to 8 names are needed"),
        (instead("fingerprint", np.array([b"\x1b", b"[", b"A"])), "fingerprint is not made of distinct words"),
    ],
)
def test_spoiled_minds(file: Path, spoil: Callable[[h5py.File], None], message: str) -> None:
    with h5py.File(file, "r+") as f:
        spoil(f)
    with pytest.raises(BabblingError, match=message) as caught:
        load(file, Mind)
    assert str(file) in str(caught.value) and "\n" not in str(caught.value)


def test_no_file_a_directory_text_and_another_netcdf(file: Path, tmp_path: Path) -> None:
    with pytest.raises(BabblingError, match=r"none\.nc: there is no such file"):
        load(tmp_path / "none.nc", Mind)
    with pytest.raises(BabblingError, match="a directory"):
        load(tmp_path, Mind)
    with pytest.raises(BabblingError, match="cannot be read"):
        load(file / "below.nc", Mind)
    text = tmp_path / "text.nc"
    text.write_text("not a forward model\n")
    with pytest.raises(BabblingError, match="not a readable NetCDF-4 file"):
        load(text, Mind)
    other = tmp_path / "other.nc"
    with h5py.File(other, "w") as f:
        f["x"] = np.arange(3)
    with pytest.raises(BabblingError, match="not a file of kind"):
        load(other, Mind)
    assert is_kind(file, Mind)
    assert not any(is_kind(path, Mind) for path in (text, other, tmp_path, tmp_path / "none.nc"))


def test_huge_files_are_refused_before_they_are_read(file: Path, tmp_path: Path) -> None:
    with open(tmp_path / "huge.nc", "wb") as f:
        os.truncate(f.fileno(), 10 << 30)
    assert (10 << 30) > LARGEST_BYTES
    with pytest.raises(BabblingError, match=r"has 10,240 MB where at most 1,024 MB are read"):
        load(tmp_path / "huge.nc", Mind)
    name = "forward_model_table_counts"
    with h5py.File(file, "r+") as f:  # small on disk, 80 GB once unpacked; only what is asked for counts
        shape = (100, 1000, 100, 1000)
        f.create_dataset("zeros", shape, np.int64, chunks=(1, 1, 100, 1000), compression="gzip")
    load(file, Mind)
    with h5py.File(file, "r+") as f:
        del f[name]
        f.move("zeros", name)
    assert file.stat().st_size < 1 << 20
    with pytest.raises(BabblingError, match=f"{name} has shape|{name} unpacks to 8"):
        load(file, Mind)


def test_a_piece_that_unpacks_to_more_than_it_says_is_not_unpacked(file: Path) -> None:
    with h5py.File(file, "r+") as f:
        del f["pilot_motors_rest"]
        data = f.create_dataset("pilot_motors_rest", (3,), float, chunks=(3,), compression="gzip")
        data.id.write_direct_chunk((0,), b"\0" * (LARGEST_PIECE + 1))
    with pytest.raises(BabblingError, match="pilot_motors_rest is 1 pieces; "):
        load(file, Mind)


def test_what_could_not_be_read_again_is_not_written(arm_mind: Mind, tmp_path: Path) -> None:
    wild = replace(arm_mind, temper=Temper(np.array([0.5, np.nan, 0.5]), np.ones(3), np.zeros(3)))
    with pytest.raises(BabblingError, match="cannot be written: temper_eagerness holds nan; 0 to 2"):
        save(wild, tmp_path / "arm.nc")
    few = replace(arm_mind, temper=Temper.cautious(2))
    with pytest.raises(BabblingError, match=r"temper_eagerness has shape \(2,\); \(3,\) is needed"):
        save(few, tmp_path / "arm.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_keeps_nothing_half_done(arm_mind: Mind, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BabblingError, match="cannot be written"):
        save(arm_mind, tmp_path / "file" / "arm.nc")
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


def test_forward_models_of_another_pilot_are_refused(arm_mind: Mind) -> None:
    model, frame = arm_mind.pilot.forward_model(), arm_mind.pilot.frame
    model.frame = replace(frame, line=frame.line + 1)
    with pytest.raises(BabblingError, match="another frame than its pilot found"):
        replace(arm_mind, forward_model=model)


def test_a_file_that_lost_an_end_of_its_seal_is_damaged(file: Path, tmp_path: Path) -> None:
    whole, path = file.read_bytes(), tmp_path / "cut.nc"
    for lost in (1, 3, 31, 40):
        path.write_bytes(whole[:-lost])
        with pytest.raises(BabblingError, match="damaged"):
            load(path, Mind)
