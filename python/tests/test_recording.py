"""Recordings of arrays, frames and files are the same numbers."""

from __future__ import annotations

import pickle
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import quell
import scipy.io

T = np.arange(100) / 250.0
Q = np.sin(T)
D = 1e-3 * np.cos(9.0 * T)
UNITS = {"motor_position": "deg", "deformation": "mrad"}


def expected(recording: quell.Recording) -> None:
    """In SI, to the rounding of one multiplication."""
    np.testing.assert_allclose(recording["motor_position"].array, np.deg2rad(Q), rtol=1e-15)
    np.testing.assert_allclose(recording["deformation"].array, 1e-3 * D, rtol=1e-15)
    np.testing.assert_allclose(recording["deformation"].stamps, T, atol=1e-12)
    assert [channel.unit for channel in recording.channels] == ["rad", "rad"]


def test_arrays_frames_and_files_are_one(tmp_path: Path) -> None:
    arrays = quell.Recording.from_arrays({"motor_position": Q, "deformation": D}, rate=250, units=UNITS)
    expected(arrays)
    named = {"time": T, "motor_position_deg": Q, "deformation_mrad": D}
    expected(quell.Recording.from_pandas(pd.DataFrame(named)))
    expected(quell.Recording.from_pandas(pd.DataFrame(named).set_index("time")))
    instants = pd.to_datetime(np.round(1e6 * (T + 1.7e9)), unit="us")
    for index in (instants, instants.tz_localize("Europe/Paris")):
        expected(quell.Recording.from_pandas(pd.DataFrame(named).set_index(index).drop(columns="time")))
    nanoseconds = {**named, "time": np.round(1e9 * T).astype(np.int64) + 1_700_000_000_000_000_000}
    expected(quell.Recording.from_pandas(pd.DataFrame(nanoseconds), time_unit="ns"))
    with pytest.raises(quell.RecordingError, match="time or rate"):
        quell.Recording.from_pandas(pd.DataFrame(named).drop(columns="time"))

    np.savez(tmp_path / "a.npz", **named)
    expected(quell.Recording.load(tmp_path / "a.npz"))
    scipy.io.savemat(tmp_path / "a.mat", {"log": {"t": T, "q": np.stack([Q, D], axis=1)}})
    channels = {"motor_position": "log.q[0]", "deformation": "log.q[1]"}
    expected(quell.Recording.load(tmp_path / "a.mat", channels, time="log.t", units=UNITS))
    with h5py.File(tmp_path / "b.mat", "w", userblock_size=512) as file:
        file["log/t"], file["log/q"] = T[np.newaxis], np.stack([Q, D])
    # The first bytes by which MATLAB marks its version.
    with (tmp_path / "b.mat").open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    expected(quell.Recording.load(tmp_path / "b.mat", channels, time="log.t", units=UNITS))

    again = pickle.loads(pickle.dumps(arrays))
    expected(again)
    expected(quell.Recording.load(arrays.save(tmp_path / "folder")))
    assert again.to_pandas().shape == (100, 2)


def test_an_episode_of_a_parquet_file_is_a_recording(tmp_path: Path) -> None:
    state = np.stack([np.concatenate([Q, Q + 1.0]), np.concatenate([D, D + 1.0])], axis=1)
    columns = {
        "timestamp": np.concatenate([T, T]),
        "episode_index": np.repeat([0, 1], len(T)),
        "observation.state": list(state),
    }
    pq.write_table(pa.table(columns), tmp_path / "file.parquet")
    channels = {"motor_position": "observation.state[0]", "deformation": "observation.state[1]"}
    where = {"episode_index": 0}
    expected(quell.Recording.load(tmp_path / "file.parquet", channels, units=UNITS, where=where))
    with pytest.raises(quell.RecordingError, match="no row has"):
        quell.Recording.load(tmp_path / "file.parquet", channels, where={"episode_index": 7})
    with pytest.raises(quell.RecordingError, match="begins again with each episode_index: take one, as where="):
        quell.Recording.load(tmp_path / "file.parquet", channels, units=UNITS)


def test_an_episode_at_30_samples_a_second_is_diagnosed_or_refused(tmp_path: Path) -> None:
    rate, fine, late = 30, 100, 0.08
    t = np.arange(600) / rate
    command = 0.3 * (1.0 - np.cos(1.3 * t)) + 0.2 * (1.0 - np.cos(2.9 * t)) + 0.1 * (1.0 - np.cos(5.2 * t))
    # A servo that is late: u'' = 40 (12 (r - u) - u'), the command held over a sample.
    held = np.concatenate([np.zeros(int(late * rate * fine)), np.repeat(command, fine)])
    x, v, state = 0.0, 0.0, []
    for k in range(len(t) * fine):
        if k % fine == 0:
            state.append(x)
        v += 40.0 * (12.0 * (held[k] - x) - v) / (rate * fine)
        x += v / (rate * fine)
    seen = np.array(state) + 2e-4 * np.random.default_rng(3).normal(size=len(t))
    columns = {
        "timestamp": t.astype(np.float32),
        "episode_index": np.zeros(len(t), dtype=np.int64),
        "action": list(command[:, np.newaxis].astype(np.float32)),
        "observation.state": list(seen[:, np.newaxis].astype(np.float32)),
    }
    pq.write_table(pa.table(columns), tmp_path / "file-000.parquet")

    def episode(role: str) -> quell.Recording:
        channels = {"command_position": "action[0]", role: "observation.state[0]"}
        units = {"command_position": "rad", role: "rad"}
        where = {"episode_index": 0}
        return quell.Recording.load(tmp_path / "file-000.parquet", channels, units=units, where=where)

    servo = "mass = { value = 1.0, fixed = true }\nviscous = 0.0\nposition_gain = 12.0\nvelocity_gain = 40.0\n"
    servo = 'kind = "rigid_axis"\ninput_hold = "zero_order"\n' + servo
    found = quell.diagnose(quell.Model.from_toml(servo, "servo"), episode("motor_position"))
    assert found.findings[0].effect in {"drive_delay", "sensor_delay"}
    assert found.findings[0].parameters[0].value == pytest.approx(late, rel=0.02)
    fast = 'kind = "flexible_joint"\nnatural_frequency_hz = 22\ndamping_ratio = 0.03\n'
    with pytest.raises(quell.DiagnosisError, match="at more than 44 Hz"):
        quell.diagnose(quell.Model.from_toml(fast, "fast"), episode("link_position"))


def test_missing_samples_are_left_out_or_refused() -> None:
    values = Q.copy()
    values[[3, 40]] = np.nan
    channel = quell.Channel(values, T, "rad")
    dropped = quell.Recording.from_arrays({"motor_position": channel}, missing="drop")
    assert len(dropped["motor_position"].stamps) == 98
    # Columns that have a missing value of their own, beside NaN.
    nullable = pd.DataFrame({"t": T, "motor_position_rad": pd.Series(values).astype("Float64")})
    assert len(quell.Recording.from_pandas(nullable)["motor_position"].stamps) == 98
    with pytest.raises(quell.RecordingError, match="motor_position: sample 3 is NaN"):
        quell.Recording.from_arrays({"motor_position": channel})


def test_a_csv_file_and_its_errors_are_those_of_the_command_line(tmp_path: Path) -> None:
    file = tmp_path / "decay.csv"
    file.write_text("t [ms];accel_x [g]\n0,0;0,11\n0,5;-0,02\n1,0;0,07\n")
    recording = quell.Recording.load(file)
    assert recording["tip_acceleration"].array[0] == pytest.approx(0.11 * 9.80665)
    (tmp_path / "recording.toml").write_text(
        'name = "a"\n[[channel]]\nrole = "motor_position"\nfile = "q.csv"\ntime = "t"\ncolumn = "q"\nunit = "rad"\n'
    )
    (tmp_path / "q.csv").write_text("t,q\n0,1\n0.1,x\n")
    with pytest.raises(quell.RecordingError, match='"x" is not a number') as caught:
        quell.Recording.load(tmp_path)
    error = caught.value
    assert (error.file, error.line, error.column) == (str(tmp_path / "q.csv"), 3, "q")


@pytest.mark.parametrize(
    ("words", "arguments"),
    [
        ("did you mean \"motor_position\"", {"channels": {"motor_positon": Q}, "rate": 250, "units": {"motor_positon": "rad"}}),
        ('unknown unit "degrees"', {"channels": {"deformation": Q}, "rate": 250, "units": {"deformation": "degrees"}}),
        ("says its unit, such as rad or m", {"channels": {"deformation": Q}, "rate": 250}),
        ("either time or rate", {"channels": {"torque": Q}}),
        ("100 values and 99 stamps", {"channels": {"torque": Q}, "time": T[1:]}),
        ("sample 1 follows", {"channels": {"torque": Q[:2]}, "time": [1.0, 1.0]}),
        ("it has 2 columns", {"channels": {"torque": np.stack([Q, Q], axis=1)}, "time": T}),
        (r"shape \(2, 2, 2\)", {"channels": {"torque": np.zeros((2, 2, 2))}, "rate": 1}),
        ("no samples", {"channels": {"torque": []}, "rate": 1}),
        (r"shape \(\); it is \(n,\)", {"channels": {"torque": 1.0}, "rate": 1}),
        ("torque has 100, motor_current has 99", {"channels": {"torque": Q, "motor_current": Q[1:]}, "rate": 250}),
        ("torque: sample 1 is 'abc'", {"channels": {"torque": [0.0, "abc"]}, "rate": 1}),
        ("torque: sample 1 is 'abc'", {"channels": {"torque": np.array([0.0, "abc"], dtype=object)}, "rate": 1}),
        ("tip_position: sample 0 of column 2 is", {"channels": {"tip_position": [[0.0, 1.0, {}]]}, "rate": 1}),
        ("torque: time: sample 1 is 'noon'", {"channels": {"torque": [0.0, 1.0]}, "time": ["0", "noon"]}),
        ("torque: its samples are complex", {"channels": {"torque": 1j * Q}, "rate": 1}),
        ("torque: sample 1 is NaN", {"channels": {"torque": np.ma.masked_equal([0.0, 9.0, 1.0], 9.0)}, "rate": 1}),
    ],
)
def test_bad_arrays_are_refused(words: str, arguments: dict) -> None:
    with pytest.raises(quell.RecordingError, match=words):
        quell.Recording.from_arrays(**arguments)


def test_a_variable_that_is_absent_is_told_beside_those_that_are_there(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", t=T, q=Q)
    with pytest.raises(quell.RecordingError, match=r"there are: t \(100,\), q \(100,\)") as caught:
        quell.Recording.load(tmp_path / "a.npz", {"torque": "tau"})
    assert caught.value.column == "tau"
    with pytest.raises(quell.RecordingError, match="no variable is called as a role"):
        quell.Recording.load(tmp_path / "a.npz")
    (tmp_path / "bad.npz").write_bytes(b"no archive")
    for name in ("bad.npz", "absent.mat"):
        with pytest.raises(quell.RecordingError, match=name):
            quell.Recording.load(tmp_path / name)
