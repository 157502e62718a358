"""OME-Zarr to encode, as its specification (NGFF 0.4 and 0.5) has it."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr

import sgicodec
from sgicodec.errors import MissingExtraError, PictureError, UsageError
from sgicodec.image.reader import probe
from sgicodec.image.source import open_source
from sgicodec.metadata.gdal_items import band_facts
from sgicodec.metadata.georeference import resolution

AXES = {
    "t": {"name": "t", "type": "time"},
    "c": {"name": "c", "type": "channel"},
    **{name: {"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"},
}
RGB = ({"color": "FF0000"}, {"color": "00FF00"}, {"color": "0000FF"})


def ngff(
    path: Path, samples: np.ndarray, order: str = "cyx", *, version: str = "0.5", channels: Any = (), **changes: Any
) -> Path:
    """An image of one level."""
    zarr_format = 2 if version == "0.4" else 3
    separator = {"chunk_key_encoding": {"name": "v2", "separator": "/"}} if zarr_format == 2 else {}
    chunks = tuple(1 if name not in "yx" else min(50, size) for name, size in zip(order, samples.shape, strict=True))
    group = zarr.open_group(path, mode="w", zarr_format=zarr_format)
    array = group.create_array("0", shape=samples.shape, chunks=chunks, dtype=samples.dtype, **separator)
    array[:] = samples
    scale = {"type": "scale", "scale": [{"y": 0.5, "x": 0.25}.get(name, 1.0) for name in order]}
    multiscale = {
        "axes": [AXES[name] for name in order],
        "datasets": [{"path": "0", "coordinateTransformations": [scale]}],
    } | changes
    image = {"multiscales": [multiscale]} | ({"omero": {"channels": list(channels)}} if channels else {})
    group.attrs.update(image | {"version": "0.4"} if version == "0.4" else {"ome": image | {"version": version}})
    return path


def ramp(*shape: int, dtype: str = "uint16") -> np.ndarray:
    return (np.arange(np.prod(shape)).reshape(shape) % 50_000).astype(dtype)


@pytest.mark.parametrize("version", ["0.4", "0.5"])
def test_channels_are_bands_with_names(version: str, tmp_path: Path) -> None:
    samples = ramp(3, 70, 90)
    channels = [{"label": "DAPI", "color": "0000FF"}, {"label": "<Cy3> & \x07", "color": "FF0000"}, {"color": "FFFFFF"}]
    picture = sgicodec.read(ngff(tmp_path / "a.zarr", samples, version=version, channels=channels))
    np.testing.assert_array_equal(picture.pixels, np.moveaxis(samples, 0, -1))
    assert picture.channels == "multi"
    assert [facts.description for facts in band_facts(picture.metadata.geo, 3)] == ["DAPI", "<Cy3> &  ", None]
    assert resolution(picture.metadata.geo, None).microns == (0.25, 0.5)


@pytest.mark.parametrize(
    ("count", "channels", "lost"),
    [
        (1, [{"label": "DAPI", "color": "0000ff"}], "colours of channels"),
        (2, [{"label": "DAPI", "color": "0000FF"}, {"label": "x", "color": "FFFFFF"}], "colours of channels"),
        (1, [{"label": "Gray", "color": "FFFFFF"}], None),
        (3, RGB, None),
        (2, (), None),
    ],
)
def test_what_is_not_kept_of_channels_is_said(count: int, channels: Any, lost: str | None, tmp_path: Path) -> None:
    with open_source(ngff(tmp_path / "a.zarr", ramp(count, 5, 6, dtype="uint8"), channels=channels)) as source:
        assert source.notes == ((f"not kept: {lost}",) if lost else ())
        named = channels and channels[0].get("label") == "DAPI"
        assert [facts.description for facts in band_facts(source.metadata.geo, 1)] == ["DAPI" if named else None]


def test_labels_and_further_images_are_said(tmp_path: Path) -> None:
    path = ngff(tmp_path / "a.zarr", ramp(1, 5, 6), version="0.4")
    group = zarr.open_group(path, mode="r+")
    group.create_group("labels")
    group.attrs.update({"multiscales": group.attrs["multiscales"] * 2, "image-label": {"colors": []}})
    with open_source(path) as source:
        assert source.notes == ("not kept: labels, further images, colours of labels",)


@pytest.mark.parametrize(
    ("count", "channels", "layout"),
    [
        (1, [{"color": "FF0000"}], "gray"),
        (3, RGB, "rgb"),
        (3, [{"label": name} for name in ("Red", "green", "BLUE")], "rgb"),
        (3, RGB[::-1], "multi"),
        (3, (), "multi"),
        (4, [{"label": name} for name in ("Red", "Green", "Blue", "Alpha")], "rgba"),
        (4, RGB, "multi"),
        (2, [{"label": "Gray"}, {"label": "Alpha"}], "gray+alpha"),
        (2, (), "multi"),
    ],
)
def test_what_channels_are(count: int, channels: Any, layout: str, tmp_path: Path) -> None:
    path = ngff(tmp_path / "a.zarr", ramp(count, 5, 6, dtype="uint8"), channels=channels)
    found = probe(path)
    assert (found.channels, found.count, found.width, found.height) == (layout, count, 6, 5)


@pytest.mark.parametrize("axes", ["yx", "zyx", "tczyx", "tcyx", "czyx"])
def test_planes_are_pages(axes: str, tmp_path: Path) -> None:
    sizes = {"t": 2, "c": 3, "z": 4, "y": 5, "x": 6}
    samples = ramp(*(sizes[name] for name in axes))
    path = ngff(tmp_path / "a.zarr", samples, axes)
    times, depths = (sizes[name] if name in axes else 1 for name in "tz")
    with open_source(path) as source:
        assert source.pages == times * depths
    for page in range(times * depths):
        t, z = divmod(page, depths)
        plane = samples[tuple({"t": t, "z": z}.get(name, slice(None)) for name in axes)]
        expected = np.moveaxis(plane, 0, -1) if "c" in axes else plane[..., None]
        np.testing.assert_array_equal(sgicodec.read(path, page=page + 1).pixels, expected)
    with pytest.raises(UsageError, match=f"there is no page {times * depths + 1}"):
        sgicodec.read(path, page=times * depths + 1)


@pytest.mark.parametrize("dtype", ["int16", ">u2", "int32", "float64", "float32"])
def test_samples_of_other_types(dtype: str, tmp_path: Path) -> None:
    samples = ramp(1, 5, 6, dtype=dtype)
    pixels = sgicodec.read(ngff(tmp_path / "a.zarr", samples, version="0.4")).pixels
    assert pixels.dtype == ("uint16" if dtype == ">u2" else "float32")
    np.testing.assert_array_equal(pixels[..., 0], samples[0])


def test_windows_are_parts_of_the_whole(tmp_path: Path) -> None:
    path = ngff(tmp_path / "a.zarr", ramp(3, 170, 190, dtype="uint8"), channels=RGB)
    whole = sgicodec.read(path).pixels
    with open_source(path) as source:
        for x, y, width, height in ((0, 0, 190, 60), (40, 45, 70, 80), (120, 130, 70, 40)):
            np.testing.assert_array_equal(source.read(x, y, width, height).pixels, whole[y : y + height, x : x + width])


def test_what_is_no_picture(tmp_path: Path) -> None:
    def refused(path: Path) -> str:
        with pytest.raises(PictureError) as error:
            sgicodec.read(path)
        assert str(error.value).startswith(f"{path}: ")
        assert "\n" not in str(error.value)
        return str(error.value)

    zarr.open_group(tmp_path / "empty.zarr", mode="w")
    assert "Zarr without an image of OME" in refused(tmp_path / "empty.zarr")
    zarr.open_group(tmp_path / "plate.zarr", mode="w").attrs["ome"] = {"plate": {}}
    assert "several images; name one of them, such as plate.zarr/0" in refused(tmp_path / "plate.zarr")
    zarr.create_array(tmp_path / "array.zarr", shape=(5, 5), dtype="uint8")
    assert "no group of Zarr" in refused(tmp_path / "array.zarr")
    assert "its axes are x, y" in refused(ngff(tmp_path / "axes.zarr", ramp(5, 6), "yx", axes=[AXES["x"], AXES["y"]]))
    assert "metadata are damaged" in refused(ngff(tmp_path / "none.zarr", ramp(5, 6), "yx", datasets=[]))
    assert "samples are of type int64" in refused(ngff(tmp_path / "long.zarr", ramp(5, 6, dtype="int64"), "yx"))
    broken = ngff(tmp_path / "broken.zarr", ramp(1, 60, 60))
    next(filter(Path.is_file, (broken / "0" / "c").rglob("*"))).write_bytes(b"nonsense")
    assert "it is damaged: " in refused(broken)
    shutil.rmtree(broken / "0")
    refused(broken)


def test_zarr_is_missing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = ngff(tmp_path / "a.zarr", ramp(1, 5, 6))
    monkeypatch.setitem(__import__("sys").modules, "zarr", None)
    with pytest.raises((MissingExtraError, PictureError), match="reading OME-Zarr needs zarr"):
        sgicodec.read(path)


@pytest.mark.parametrize("axes", [None, ["t", "c", "z", "y", "x"]])
def test_versions_before_0_4(axes: list[str] | None, tmp_path: Path) -> None:
    """0.3 names axes, 0.1 and 0.2 always have five; neither states sizes."""
    samples = ramp(1, 2, 3, 5, 6)
    path = ngff(tmp_path / "a.zarr", samples, "tczyx", version="0.4")
    scales = {"datasets": [{"path": "0"}]} | ({} if axes is None else {"axes": axes})
    zarr.open_group(path, mode="r+").attrs["multiscales"] = [scales]
    picture = sgicodec.read(path, page=3)
    np.testing.assert_array_equal(picture.pixels, np.moveaxis(samples[0, :, 2], 0, -1))
    assert picture.metadata.geo is None
