"""Files appear whole or not at all, and say so when they are not."""

import time
from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from storage.blocks import write_blocks
from storage.netcdf import read_whole, write_whole
from storage.sealed import seal
from surrogate import FormatError
from tests.refusals import assert_refused


def sample() -> xr.Dataset:
    rng = np.random.default_rng(0)
    return xr.Dataset(
        {
            "field": (("case", "position"), rng.normal(size=(60, 100)), {"units": "Pa", "valid": [1, 2], "k": 3.5}),
            "time": ("case", np.arange(60.0), {"units": "s"}),
            "holes": ("case", np.where(np.arange(60) % 7, 1.0, np.nan)),
            "flag": ("case", np.arange(60) % 3 == 0),
            "count": ("case", np.arange(60, dtype=np.int32)),
            "name": ("case", [f"µ-{k}" for k in range(60)]),
            "single": ((), np.float32(2.5)),
        },
        coords={"position": np.linspace(-1, 1, 100), "label": ("case", ["a"] * 60)},
        attrs={"Conventions": "CF-1.11", "version": 1, "title": ""},
    )


def test_round_trip_keeps_values_types_and_attributes(tmp_path: Path) -> None:
    path = tmp_path / "one.nc"
    write_whole(sample(), path)
    again = read_whole(path)
    assert again.attrs.pop("checksum")
    assert again.attrs.pop("summary").startswith("data set: field, time, holes")
    assert again.attrs.pop("license") == "MIT"
    assert again.attrs.pop("history").startswith("written by meecontact ")
    xr.testing.assert_identical(again.drop_vars(["name", "label"]), sample().drop_vars(["name", "label"]))
    assert again["name"].values.tolist() == sample()["name"].values.tolist()
    assert again["flag"].dtype == bool
    assert "label" in again.coords
    assert list(tmp_path.iterdir()) == [path]


def test_equal_data_sets_give_equal_bytes_and_a_read_one_can_be_written_again(tmp_path: Path) -> None:
    write_whole(sample(), tmp_path / "a.nc")
    time.sleep(1.1)  # a clock in the file would show
    write_whole(sample(), tmp_path / "b.nc")
    write_whole(read_whole(tmp_path / "a.nc"), tmp_path / "c.nc")
    assert len({(tmp_path / name).read_bytes() for name in ("a.nc", "b.nc", "c.nc")}) == 1


@pytest.mark.parametrize(
    ("units", "stored"),
    [("C m-3/2", "C m-2"), ("T m1/2", "T"), ("m1/2", "1"), ("N m3/2 s-1", "N m s-1"), ("V m N-1", "V m N-1")],
)
def test_a_root_of_a_metre_is_stored_as_a_scaled_quantity(units: str, stored: str, tmp_path: Path) -> None:
    data = xr.Dataset({"f": ("x", [1.0, 2.0], {"units": units, "long_name": "intensity"})})
    write_whole(data, tmp_path / "a.nc")
    write_blocks(tmp_path / "b.nc", data, [((slice(0, 2),), {"f": data["f"].values})], {})
    for name in ("a.nc", "b.nc"):
        with netCDF4.Dataset(tmp_path / name) as file:
            assert file["f"].units == stored  # no fraction: UDUNITS reads m-3/2 as 0.5 m-3
            assert file["f"].long_name.endswith("the square root of 1 m") == (units != stored)
        for lazy in (False, True):
            with read_whole(tmp_path / name, lazy=lazy) as again:
                assert (again["f"].attrs["units"], again["f"].attrs["long_name"]) == (units, "intensity")


def test_truncation_is_found_at_every_length(tmp_path: Path) -> None:
    write_whole(sample(), tmp_path / "a.nc")
    whole = (tmp_path / "a.nc").read_bytes()
    for length in [0, 1, 7, 8, 100, *range(512, len(whole), len(whole) // 40), len(whole) - 1]:
        (tmp_path / "cut.nc").write_bytes(whole[:length])
        for lazy in (False, True):
            assert_refused(FormatError, r"cut\.nc: ", read_whole, tmp_path / "cut.nc", lazy=lazy)


CHANGES: dict[str, Callable[[netCDF4.Dataset], object]] = {
    "value": lambda file: file["field"].__setitem__((5, 5), 0.0),
    "attribute": lambda file: file["field"].setncattr("units", "kPa"),
    "header": lambda file: file.setncattr("version", 2),
    "name": lambda file: file.renameVariable("time", "tine"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_value_attribute_or_name_is_detected(change: str, tmp_path: Path) -> None:
    write_whole(sample(), tmp_path / "a.nc")
    with netCDF4.Dataset(tmp_path / "a.nc", "a") as file:
        CHANGES[change](file)
    assert_refused(FormatError, r"no seal|do not match its seal", read_whole, tmp_path / "a.nc")
    seal(tmp_path / "a.nc")  # a seal put on afterwards does not help
    assert_refused(FormatError, r"a\.nc: altered: its contents", read_whole, tmp_path / "a.nc")


def test_a_flipped_byte_anywhere_is_found_before_the_library_reads_it(tmp_path: Path) -> None:
    write_whole(sample(), tmp_path / "a.nc")
    whole = (tmp_path / "a.nc").read_bytes()
    for position in range(0, len(whole), 389):
        changed = bytearray(whole)
        changed[position] ^= 0x10
        (tmp_path / "a.nc").write_bytes(changed)
        assert_refused(FormatError, r"altered: its bytes|no seal", read_whole, tmp_path / "a.nc")


def foreign(path: Path, size: int | None) -> None:
    """Write a netCDF file with one dimension and a false checksum."""
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("x", size)
        file.createVariable("x", "f8", ("x",), compression="zlib", chunksizes=(2**16,))
        file.checksum = "0"


@pytest.mark.parametrize(
    ("write", "said"),
    [
        (lambda path: path.write_text("material,radius\n"), "no readable netCDF-4"),
        (lambda path: sample().to_netcdf(path, engine="netcdf4"), "it has no checksum"),
        (lambda path: foreign(path, 2**40), "too large: it unpacks to 8796093022208 bytes"),
        (lambda path: foreign(path, None), "unlimited dimension 'x'"),
    ],
)
def test_a_file_of_another_program_is_refused_with_a_seal_too(
    write: Callable[[Path], object], said: str, tmp_path: Path
) -> None:
    write(tmp_path / "a.nc")
    for lazy in (False, True):
        assert_refused(FormatError, "incomplete: it has no seal", read_whole, tmp_path / "a.nc", lazy=lazy)
    seal(tmp_path / "a.nc")
    assert_refused(FormatError, said, read_whole, tmp_path / "a.nc")


def test_nothing_and_too_much_are_named(tmp_path: Path) -> None:
    assert_refused(FileNotFoundError, "no such file", read_whole, tmp_path / "b.nc")
    assert_refused(FileNotFoundError, "is a folder", read_whole, tmp_path)
    assert_refused(FileNotFoundError, "does not exist", write_whole, sample(), tmp_path / "folder" / "b.nc")
    write_whole(sample(), tmp_path / "b.nc")
    assert_refused(FormatError, "too large", read_whole, tmp_path / "b.nc", max_bytes=1000)


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    write_whole(sample(), tmp_path / "a.nc")
    before = (tmp_path / "a.nc").read_bytes()
    with pytest.raises(TypeError, match="cannot store"):
        write_whole(sample().assign(bad=("case", np.array([{}] * 60))), tmp_path / "a.nc")
    with pytest.raises(ValueError, match="slash"):  # of the library, when the file is begun
        write_whole(sample().rename(single="a/b"), tmp_path / "a.nc")
    assert (tmp_path / "a.nc").read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["a.nc"]
