"""Result files that were damaged, cut, edited or made elsewhere: one line each, before HDF5 sees them."""

from __future__ import annotations

import hashlib
import io
import json

import h5py
import numpy as np
import pytest
import xarray as xr

import trunnion as tn
from trunnion.errors import ComputationError, InputError
from trunnion.numerics.patches.patches import PatchedFunction
from trunnion.results.chart import StabilityChart, read_chart
from trunnion.results.files import dataset_bytes, read_dataset, save_dataset


def chart() -> StabilityChart:
    """A small chart of made-up numbers: reading does not compute."""
    shape = (3, 4)
    return StabilityChart(
        x=np.arange(1.0, 5), y=np.arange(3.0), x_parameter="speed", y_parameter="load", x_unit="rad/s", y_unit="N*m",
        spectral_radius=np.full(shape, 0.5), error_estimate=np.full(shape, 1e-9),
        critical_multiplier=np.full(shape, 0.5 + 0j), verdict=np.zeros(shape, np.int8), speed=None, period=3.0,
        tolerance=1e-9, statically_twisted=False, remarks=("note",), line=None, function=PatchedFunction((), ()),
    )  # fmt: skip


@pytest.fixture(scope="module")
def content(tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("chart") / "chart.nc"
    chart().save(path)
    return path.read_bytes()


def damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """One of the ways in which copies, disks and mails spoil a file."""
    place, other = sorted(rng.integers(0, len(content), 2).tolist())
    match rng.integers(0, 7):
        case 0:
            flipped = content[place] ^ (1 << int(rng.integers(0, 8)))
            return content[:place] + bytes([flipped]) + content[place + 1 :]
        case 1:
            return content[:place]
        case 2:
            return content[:place] + content[other + 1 :]
        case 3:
            return content[:place] + bytes(rng.integers(0, 256, 1 + other - place, dtype=np.uint8)) + content[other:]
        case 4:
            return content + content[place : other + 1]
        case 5:
            return content[:place] + b"\0" * (other - place + 1) + content[other + 1 :]
    return content.replace(b"\n", b"\r\n")


def refused(path, content: bytes) -> str:
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_chart(path)
    line = str(caught.value)
    named = line.split(": ")[0].removeprefix("…")  # of a long path the end, which names the file
    assert str(path).endswith(named) and named.endswith(path.name) and "\n" not in line and len(line) < 400
    return line


@pytest.mark.parametrize("seed", [*range(30), *(pytest.param(i, marks=pytest.mark.slow) for i in range(30, 300))])
def test_a_damaged_chart_is_one_line(content, tmp_path, seed):
    rng, spoilt = np.random.default_rng(seed), content
    while spoilt == content:  # some ways change nothing of some files
        spoilt = damaged(content, rng)
    assert "checksum" in refused(tmp_path / "chart.nc", spoilt)


def test_a_whole_chart_is_read(content, tmp_path):
    (tmp_path / "chart.nc").write_bytes(content)
    again = read_chart(tmp_path / "chart.nc")
    assert np.array_equal(again.spectral_radius, chart().spectral_radius) and again.remarks == ("note",)


def signed(body: bytes) -> bytes:
    return body + b"\ntrunnion sha256 " + hashlib.sha256(body).hexdigest().encode() + b"\n"


def edited(content: bytes, change) -> bytes:
    """The chart after ``change``, with a checksum that fits: what somebody does on purpose."""
    stream = io.BytesIO(content)
    with h5py.File(stream, "r+") as file:
        change(file)
    return signed(stream.getvalue())


def removed(name):
    return lambda file: file.__delitem__(name)


def without(name):
    return lambda file: file.attrs.__delitem__(name)


def said(name, value):
    return lambda file: file.attrs.__setitem__(name, value)


EDITS = [
    *(removed(name) for name in ("verdict", "spectral_radius", "x", "patch_box", "critical_multiplier_imaginary")),
    *(without(name) for name in ("spot_check", "speed", "driveline", "x_parameter", "remarks", "period", "format")),
    *(said(name, "{") for name in ("spot_check", "x_parameter", "remarks", "tolerance", "driveline")),
    *(said(name, 3) for name in ("x_parameter", "remarks", "driveline", "format", "spot_check")),
    said("format_version", 2),
    said("format", "trunnion stability chart 99"),
]


@pytest.mark.parametrize("change", EDITS)
def test_an_edited_chart_is_one_line(content, tmp_path, change):
    assert refused(tmp_path / "chart.nc", edited(content, change))


def test_files_from_elsewhere(content, tmp_path):
    path = tmp_path / "chart.nc"
    xr.Dataset({"a": ("x", [1.0])}).to_netcdf(path, engine="h5netcdf")
    assert "checksum" in refused(path, path.read_bytes())
    for body in (b"", b"CDF\x01", b"x" * 100_000):
        refused(path, body)
        assert "not a netCDF file" in refused(path, signed(body))
    assert 'is not a "trunnion stability chart' in refused(path, dataset_bytes(xr.Dataset(attrs={"format": "other"})))
    for name in (tmp_path, tmp_path / "none.nc", "a\0b", tmp_path / ("x" * 300)):
        with pytest.raises(InputError):
            read_chart(name)


def test_any_dataset_comes_back_and_other_readers_take_it(tmp_path):
    data = xr.Dataset(
        {"torque": (("time", "shaft"), np.ones((3, 2)), {"units": "N*m"})},
        coords={"time": [0.0, 1.0, 2.0], "shaft": ["front Ω", "rear"]},
        attrs={"format": "motion", "note": "é" * 100},
    )
    save_dataset(data, tmp_path / "a.nc")
    again = read_dataset(tmp_path / "a.nc", "motion")
    xr.testing.assert_equal(again, data)
    assert again.attrs["format_version"] == 1
    with xr.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as opened:
        xr.testing.assert_equal(opened.load(), data)


@pytest.mark.parametrize("room", [0, 1, 100, 1000, 3000])
def test_a_full_disk_leaves_the_old_chart(content, tmp_path, room, monkeypatch):
    path = tmp_path / "chart.nc"
    path.write_bytes(content)

    def runs_full(self, data):
        with self.open("wb") as stream:
            stream.write(data[:room])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.write_bytes", runs_full)
    with pytest.raises(ComputationError, match=r"chart\.nc: cannot be written \(No space left"):
        chart().save(path)
    assert path.read_bytes() == content and [p.name for p in tmp_path.iterdir()] == ["chart.nc"]


def put(name, place, value):
    """One number of an array changed."""
    return lambda file: file[name].__setitem__(place, value)


def of_shape(name, shape, value=0.5):
    def change(file):
        kind = file[name].dtype
        del file[name]
        file.create_dataset(name, shape=shape, dtype=kind, fillvalue=value)

    return change


def bomb(file):
    """2.6 GB of zeros in some kilobytes."""
    del file["spectral_radius"]
    file.create_dataset("spectral_radius", shape=(18_000, 18_000), dtype="f8", compression="gzip", chunks=(1000, 1000))


def elsewhere(file):
    """Numbers of another file."""
    del file["spectral_radius"]
    file["spectral_radius"] = h5py.ExternalLink("/etc/passwd", "/x")


def raw(file):
    del file["spectral_radius"]
    file.create_dataset("spectral_radius", (3, 4), "f8", external=[("/etc/passwd", 0, 96)])


WRONG = {
    "a radius beyond numbers": (put("spectral_radius", (0, 0), 1e300), "spectral_radius lies outside"),
    "a negative radius": (put("spectral_radius", (1, 1), -0.5), "spectral_radius lies outside"),
    "an infinite radius": (put("spectral_radius", (1, 1), np.inf), "spectral_radius lies outside"),
    "a radius that is not a multiplier's": (put("spectral_radius", (1, 1), 0.7), "spectral_radius differ"),
    "a missing radius": (put("spectral_radius", (1, 1), np.nan), "failed points"),
    "a negative error": (put("error_estimate", (2, 3), -1e-9), "error_estimate is negative"),
    "a missing error": (put("error_estimate", (2, 3), np.nan), "error_estimate is negative or missing"),
    "an unknown verdict": (put("verdict", (0, 1), 77), "verdict is none of the known ones"),
    "a verdict that is not so": (put("verdict", (0, 1), 1), "verdict contradicts"),
    "an axis that falls": (put("x", 1, 9.0), "x does not rise"),
    "an axis without a number": (put("y", 1, np.nan), "y does not rise"),
    "another shape": (of_shape("spectral_radius", (4, 3)), "spectral_radius is not 3 × 4 numbers"),
    "one row": (of_shape("error_estimate", (4,)), "error_estimate is not 3 × 4 numbers"),
    "no pixels": (of_shape("verdict", (0, 0), 0), "verdict is not 3 × 4 numbers"),
    "another patch box": (of_shape("patch_box", (1, 3)), "is not a whole stability chart"),
    "an infinite period": (said("period", np.inf), "its period is not positive"),
    "a negative tolerance": (said("tolerance", -1.0), "its tolerance is not positive"),
    "a speed of zero": (said("speed", -3.0), "its speed is not positive"),
    "deep remarks": (said("remarks", "[" * 30_000), "is not a whole stability chart"),
    "numbers for remarks": (said("remarks", "[1, 2]"), "its texts are none"),
    "a long remark": (said("remarks", json.dumps(["x" * 100_000])), "its texts are none"),
    "a negative check": (
        said("spot_check", json.dumps({"points": 3, "worst_ratio": -1.0, "worst_difference": 0.0})), "is negative"
    ),
    "a bomb": (bomb, "unpacks to 2.41 GB, at most 2 GB is read"),
    "a link to another file": (elsewhere, "has parts that this program does not write"),
    "bytes of another file": (raw, "has parts that this program does not write"),
    "a group": (lambda file: file.create_group("more"), "has parts that this program does not write"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "says"), WRONG.values(), ids=WRONG.keys())
def test_contents_that_no_computation_gives_are_refused(content, tmp_path, change, says):
    """Whose checksum fits: somebody made them, or a defect did."""
    assert says in refused(tmp_path / "chart.nc", edited(content, change))


@pytest.mark.parametrize(
    ("number", "says"), [(3, "is of an older format"), (1, "is of an older format"), (5, "is of a later format")]
)
def test_another_format_is_said_to_be_older_or_later(content, tmp_path, number, says):
    line = refused(tmp_path / "chart.nc", edited(content, said("format", f"trunnion stability chart {number}")))
    assert says in line and "this Trunnion reads 4" in line
    assert ("use a newer Trunnion" in line) == (number > 4)


def test_real_charts_pass(tmp_path):
    """Of lines far into instability, with collisions, with failed points, of a family of one's own, on one column."""
    line = tn.catalogue("two-shaft-cardan")
    charts = [
        tn.stability_chart(line, ("speed", 0.3, 2.0, 30), ("HookeJoint 1.angle", 0.0, 1.2, 20)),
        tn.stability_chart(line, ("speed", 0.02, 0.03, 3), ("Shaft *.damping", 0.0, 1.0, 4)),
        tn.stability_chart(line, ("speed", 1.0, 1.0, 1), ("HookeJoint 1.angle", 0.0, 1.2, 5)),
    ]
    for k, made in enumerate(charts):
        made.save(tmp_path / f"{k}.nc")
        again = tn.load_chart(tmp_path / f"{k}.nc")
        assert np.array_equal(again.spectral_radius, made.spectral_radius, equal_nan=True)
        assert (
            again.at(float(made.x[0]), float(made.y[-1])).verdict
            == made.at(float(made.x[0]), float(made.y[-1])).verdict
        )
