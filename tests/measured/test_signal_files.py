"""The same signals from files of every kind; damaged and misdescribed ones refused in one line."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.io import savemat, wavfile

import trunnion as tn

RATE = 20_000.0
TIME = np.arange(30_000) / RATE
PULSES = 2.5 + 2.0 * np.tanh(6 * np.sin(2 * np.pi * 300 * TIME))  # 300 pulses a second
TORQUE = 40.0 * np.sin(2 * np.pi * 10 * TIME) + 120.0
DESCRIPTION = {
    "channel": [
        {"column": "pickup", "name": "wheel", "kind": "pulses", "pulses_per_turn": 30, "at": "hub"},
        {
            "column": "gauge",
            "name": "gauge",
            "kind": "torque",
            "unit": "kN*m",
            "scale": 1e-3,
            "offset": 0.01,
            "at": "tube",
        },
    ]
}


def stated(**more: object) -> dict[str, object]:
    return DESCRIPTION | more


def as_csv(path: Path) -> None:
    rows = np.column_stack([TIME, PULSES, TORQUE])
    np.savetxt(path, rows, delimiter=",", header="t,pickup,gauge", comments="", fmt="%.12g")


def as_german_csv(path: Path) -> None:
    rows = [";".join(f"{x:.12g}".replace(".", ",") for x in row) for row in zip(TIME, PULSES, TORQUE, strict=True)]
    path.write_text("t;pickup;gauge\n" + "\n".join(rows) + "\n", encoding="utf-8")


def as_mat(path: Path) -> None:
    savemat(path, {"pickup": PULSES[:, None], "gauge": TORQUE, "fs": RATE})


def as_hdf5(path: Path) -> None:
    with h5py.File(path, "w") as stream:
        for name, values in {"pickup": PULSES, "gauge": TORQUE}.items():
            stream.create_dataset(name, data=values).attrs["rate"] = RATE


def as_new_mat(path: Path) -> None:
    """As MATLAB writes version 7.3: HDF5 with matrices transposed, behind a header of 512 bytes."""
    with h5py.File(path, "w", userblock_size=512) as stream:
        stream.create_dataset("pickup", data=PULSES[None, :])
        stream.create_dataset("gauge", data=TORQUE[None, :])
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"
    with path.open("r+b") as raw:
        raw.write(head)


def as_wave(path: Path) -> None:
    wavfile.write(path, int(RATE), np.column_stack([PULSES, TORQUE]).astype(np.float32))


def as_mdf(path: Path) -> None:
    from asammdf import MDF, Signal

    with MDF(version="4.10") as stream:
        stream.append([Signal(PULSES, TIME, name="pickup"), Signal(TORQUE, TIME, name="gauge", unit="Nm")])
        stream.save(path)


def as_tdms(path: Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(path) as stream:
        stream.write_segment(
            [
                ChannelObject("bench", name, values, properties={"wf_increment": 1 / RATE})
                for name, values in {"pickup": PULSES, "gauge": TORQUE}.items()
            ]
        )


def as_universal(path: Path) -> None:
    import pyuff

    stream = pyuff.UFF(str(path))
    for name, values in {"pickup": PULSES, "gauge": TORQUE}.items():
        dataset = pyuff.prepare_58(
            binary=1, func_type=1, rsp_node=1, rsp_dir=1, ref_node=1, ref_dir=1, data=values, x=TIME, id1=name,
            rsp_ent_name=name, ref_ent_name=name, abscissa_spacing=1, abscissa_min=0.0, abscissa_inc=1 / RATE,
            abscissa_spec_data_type=17, ordinate_spec_data_type=1, orddenom_spec_data_type=1,
        )  # fmt: skip
        stream.write_sets([dataset], "add")


FORMATS: dict[str, tuple[Callable[[Path], None], dict[str, object]]] = {
    "run.csv": (as_csv, {"time": "t"}),
    "run.txt": (as_german_csv, {"rate": "20 kHz"}),
    "run.mat": (as_mat, {"rate": RATE}),
    "new.mat": (as_new_mat, {"rate": RATE}),
    "run.h5": (as_hdf5, {}),
    "run.wav": (as_wave, {}),
    "run.mf4": (as_mdf, {}),
    "run.tdms": (as_tdms, {}),
    "run.uff": (as_universal, {}),
}


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_holds_the_same(name: str, tmp_path: Path) -> None:
    write, more = FORMATS[name]
    file = tmp_path / name
    write(file)
    if name == "run.wav":
        more = {"channel": [row | {"column": k} for k, row in enumerate(DESCRIPTION["channel"], start=1)]}
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        found = tn.read_measurement(file, stated(**more))
    wheel, gauge = found.channels
    assert isinstance(wheel, tn.PulseTrain) and isinstance(gauge, tn.SampledSignal)
    near = 2e-7 if name == "run.wav" else 1e-9  # single precision
    single = 1e-5 if name == "run.wav" else 1e-9
    assert np.abs(np.diff(wheel.times) - 1 / 300).max() < 4 * near + 5e-7 and len(wheel.times) in (449, 450)
    assert (wheel.at, wheel.pulses_per_turn, gauge.name, gauge.at) == ("hub", 30, "gauge", "tube")
    # 0.001 times the column, 0.01 more, in kN m.
    assert gauge.rate == pytest.approx(RATE, rel=1e-6) and np.abs(gauge.values - (TORQUE + 10)).max() < 200 * single


@pytest.mark.parametrize("name", [name for name in FORMATS if name != "run.txt"])
def test_a_file_that_is_cut_off_is_refused_or_shorter(name: str, tmp_path: Path) -> None:
    """Never an error of a library, never numbers that were not recorded."""
    write, more = FORMATS[name]
    file = tmp_path / name
    write(file)
    content = file.read_bytes()
    if name == "run.wav":
        more = {"channel": [row | {"column": k} for k, row in enumerate(DESCRIPTION["channel"], start=1)]}
    for share in (0.0, 0.001, 0.2, 0.7, 0.999):
        file.write_bytes(content[: int(share * len(content))])
        try:
            found = tn.read_measurement(file, stated(**more))
        except tn.InputError as error:
            assert "\n" not in str(error) and len(str(error)) < 500
            continue
        gauge = found.channels[1]
        assert np.abs(gauge.values - (TORQUE + 10)[: len(gauge.values)]).max() < 1e-2


def test_the_description_stands_beside_the_file(tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    as_hdf5(file)
    with pytest.raises(tn.InputError, match=r"write run\.channels\.toml beside it.*gauge, pickup"):
        tn.read_measurement(file)
    text = '[[channel]]\ncolumn = "pickup"\nkind = "pulses"\npulses_per_turn = 30\npitch_error = "1.5 %"\nclock = "B"\n'
    (tmp_path / "run.channels.toml").write_text(text, encoding="utf-8")
    (wheel,) = tn.read_measurement(file).pulses
    assert (wheel.pitch_error, wheel.clock, wheel.name) == (0.015, "B", "pickup")
    assert sorted(one.name for one in tmp_path.iterdir()) == ["run.channels.toml", "run.h5"]  # nothing else is written


WRONG = (
    ({"channel": []}, "channels.channel: has no channel"),
    ({"rte": 1, "channel": [{"column": "a"}]}, "channels.rte = 1: unknown key; did you mean \"rate\""),
    ({"rate": -1, "channel": [{"column": "a"}]}, "channels.rate = -1: must be positive"),
    ({"channel": [{"name": "a"}]}, "channels channel 1.column: is missing"),
    ({"channel": [{"column": "pickup", "kind": "pulse"}]}, "channels channel 1.kind = 'pulse': is not known"),
    ({"channel": [{"column": "pickup", "kind": "pulses"}]}, "channels channel 1.pulses_per_turn: must be a whole"),
    ({"channel": [{"column": "gauge", "kind": "torque"}]}, "channels channel 1.unit: is missing"),
    ({"channel": [{"column": "gauge", "kind": "torque", "unit": "bar"}]}, "channels channel 1.unit = '1 bar'"),
    ({"channel": [{"column": "gauge", "scale": "2"}]}, "channels channel 1.scale = '2': must be a whole number or"),
    ({"channel": [{"column": "guage"}]}, "guage.column = 'guage': is not a column of the file; did you mean \"gauge\""),
    ({"channel": [{"column": 9}]}, "9.column = 9: is not a column of the file; there are 2"),
    ({"channel": [{"column": "pickup", "kind": "pulses", "pulses_per_turn": 30, "level": 9.0}]}, "pickup.level = 9"),
    ({"channel": [{"column": "flat", "kind": "pulses", "pulses_per_turn": 30}]}, "flat.column: does not move"),
    ({"channel": [{"column": "holes", "kind": "other"}]}, "holes.values: has no number in 3 samples, the first"),
    ({"channel": [{"column": "holes", "kind": "pulses", "pulses_per_turn": 3}]}, "holes.column: has samples that are"),
    ({"channel": [{"column": "gauge", "keep_rate": "5 m"}]}, "channels channel 1.keep_rate = '5 m'"),
    ({"channel": [{"column": "gauge", "keep_rate": 0}]}, "channels channel 1.keep_rate = 0: must be positive"),
    ({"channel": [{"column": "pickup", "kind": "pulses", "pulses_per_turn": 30, "keep_rate": 9}]},
     "channels channel 1.keep_rate = 9: belongs to a sampled signal"),
    ({"channel": [{"column": "holes", "keep_rate": 4000}]}, "holes.column: has samples that are not numbers, "),
    ({"channel": [{"column": "pickup", "kind": "pulses", "pulses_per_turn": 300}]}, "pickup.times = 449: holds less"),
)  # fmt: skip


@pytest.mark.parametrize(("description", "said"), WRONG)
def test_what_is_refused(description: dict[str, object], said: str, tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    as_hdf5(file)
    if "channel" in description and any(c.get("column") in ("flat", "holes") for c in description["channel"]):
        with h5py.File(file, "a") as stream:
            stream.create_dataset("flat", data=np.ones(1000)).attrs["rate"] = RATE
            holes = PULSES.copy()
            holes[[700, 701, 950]] = np.nan
            stream.create_dataset("holes", data=holes).attrs["rate"] = RATE
    with pytest.raises(tn.InputError) as caught:
        tn.read_measurement(file, description)
    assert str(caught.value).startswith(said), str(caught.value)
    assert "\n" not in str(caught.value)


def test_gaps_and_texts_of_a_table(tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    rows = "\n".join(f"{0.01 * k if k < 60 else 0.01 * k + 0.2:.4f},{k}" for k in range(100))
    file.write_text("t,x\n" + rows, encoding="utf-8")
    with pytest.raises(tn.InputError, match=r"^t = 0\.\d+: has steps that are not equal: there is a gap"):
        tn.read_measurement(file, {"time": "t", "channel": [{"column": "x"}]})
    file.write_text("t,x\n0,1\n0.1,2\n0.2,oops\n", encoding="utf-8")
    with pytest.raises(tn.InputError, match=r"^run\.csv line 4\.x = 'oops': is not a number"):
        tn.read_measurement(file, {"time": "t", "channel": [{"column": "x"}]})
    with pytest.raises(tn.InputError, match=r"^x\.rate: is missing"):
        tn.read_measurement(file, {"channel": [{"column": "t", "name": "x"}]})
    other = tmp_path / "run.xlsx"
    other.write_bytes(b"PK")
    with pytest.raises(tn.InputError, match="is not a file of signals; files end in .csv"):
        tn.read_measurement(other)
    with pytest.raises(tn.InputError, match="is not there"):
        tn.read_measurement(tmp_path / "none.wav")


def test_a_clipped_signal_is_said() -> None:
    gauge = tn.SampledSignal(np.clip(TORQUE, 90.0, 150.0), RATE, name="gauge", kind="torque")
    (finding,) = tn.Measurement([gauge]).findings
    assert str(finding).startswith("caution: gauge is clipped: ") and "false harmonics" in str(finding)
    assert not tn.Measurement([tn.SampledSignal(TORQUE, RATE)]).findings


@pytest.mark.parametrize("chunk", [40_000, 4096, 97])
def test_a_signal_that_is_thinned_while_it_is_read(chunk: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A slow wave stays, at the right moments; a fast one that would fold back onto it goes; cut anywhere."""
    from trunnion.measured.signals import sources

    monkeypatch.setattr(sources, "CHUNK", chunk)
    file = tmp_path / "run.h5"
    slow, fast = 3.0 * np.sin(2 * np.pi * 130 * TIME), 40.0 * np.sin(2 * np.pi * 3870 * TIME)
    with h5py.File(file, "w") as stream:
        stream.create_dataset("gauge", data=slow + fast).attrs["rate"] = RATE
        stream.create_dataset("flat", data=np.clip(slow, -9, 2.5)).attrs["rate"] = RATE
    wanted = {"kind": "torque", "unit": "N*m", "keep_rate": "4 kHz"}
    read = tn.read_measurement(file, {"channel": [{"column": one, **wanted} for one in ("gauge", "flat")]})
    gauge = read.sampled[0]
    assert gauge.rate == 4000.0 and 5900 < len(gauge.values) <= 6000
    assert np.abs(gauge.values - 3.0 * np.sin(2 * np.pi * 130 * gauge.times)).max() < 1e-4
    # What a filter hides is said before.
    clipped = np.clip(slow, -9, 2.5) == 2.5
    inner = int((clipped[:-2] & clipped[1:-1] & clipped[2:]).sum())
    (said,) = read.remarks
    assert said.startswith(f"flat is clipped: {inner} samples (") and "false harmonics" in said


@pytest.mark.slow
def test_a_minute_of_four_channels_at_200_khz(tmp_path: Path) -> None:
    """A run-up of 60 s from a binary file, orders of four pickups (its time: ``benchmarks/recordings.py``)."""
    rate, seconds = 200_000, 60.0
    at = np.arange(int(rate * seconds)) / rate
    phi = 100.0 * at + 200.0 / seconds * at**2 / 2
    volts = np.empty((len(at), 4), dtype=np.int16)
    for k in range(4):
        size = 1e-3 * k
        volts[:, k] = (20_000 * np.tanh(4 * np.sin(60 * (phi + size * np.cos(2 * phi))))).astype(np.int16)
    file = tmp_path / "run.wav"
    wavfile.write(file, rate, volts)
    wheels = [
        {"column": k + 1, "name": f"w{k}", "kind": "pulses", "pulses_per_turn": 60, "pitch_error": 0.0}
        for k in range(4)
    ]
    found = tn.track_orders(tn.read_measurement(file, {"channel": wheels}), [1, 2, 4])
    for k in range(1, 4):
        got = np.abs(found.amplitude[:, found.row(2), found.column(f"w{k}")])
        assert np.abs(got - 1e-3 * k).max() < 2e-6
