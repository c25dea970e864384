"""Identification, prediction and diagnosis: what they say, in every form; interrupts, progress, the other threads."""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import quell
import scipy.signal

from conftest import RATE


def test_a_mode_is_identified_with_its_input_known(recording: quell.Recording) -> None:
    found = quell.identify(recording)
    mode = found.modes[0]
    assert found.excitation == "known_input"
    # The motion is known at the ticks alone.
    assert (mode.frequency_hz, mode.damping_ratio) == pytest.approx((8.0, 0.05), rel=1e-3)
    assert 0.0 < mode.frequency_std_hz < 1e-3
    assert {"likelihood", "batch_fit"} <= {estimate.method for estimate in found.estimates}
    assert found.model is not None and found.model["natural_frequency_hz"] == pytest.approx(mode.frequency_hz, rel=1e-5)
    assert quell.Shaper("optimal", found, rate=500).residual(8.0) < 0.01
    assert quell.recommend(found).to_dict() == quell.recommend(found.modes).to_dict()


def test_a_shaped_command_leaves_a_simulated_robot_still_and_its_recording_is_identified() -> None:
    move, still = quell.plan(0.0, 0.5, quell.Limits(2.0, 8.0, 60.0), rate=250), 750
    left = []
    for shaper in (None, quell.Shaper("zvd", (8.12, 0.084), rate=250)):
        command = shaper.apply(move.position) if shaper else move.position
        command = np.append(command, np.full(still, command[-1]))
        moved = quell.simulate_robot(command, rate=250)
        left.append(np.abs(moved.tip_deformation[-still + 50 :]).max())
        assert moved.tip_deformation.shape == command.shape == moved.to_pandas().index.shape
        if shaper is None:
            mode = quell.identify(moved.recording, moved.model).modes[0]
            assert (mode.frequency_hz, mode.damping_ratio) == pytest.approx((8.12, 0.084), rel=0.02)
    assert left[1] < 0.03 * left[0]
    with pytest.raises(quell.SimulationError, match="--joint 9|joints 1 to"):
        quell.simulate_robot(command, rate=250, joint=9)
    with pytest.raises(quell.SimulationError, match="nowhere.toml"):
        quell.simulate_robot(command, rate=250, robot="nowhere.toml")
    with pytest.raises(quell.SimulationError, match="payload"):
        quell.simulate_robot(command, rate=250, payload=-1.0)


def test_the_forms_of_a_result_agree(recording: quell.Recording, model: quell.Model, tmp_path: Path) -> None:
    found, predicted = quell.identify(recording), quell.simulate(model, recording)
    assert found.to_pandas()["frequency_hz"][0] == found.modes[0].frequency_hz
    assert "<td>8</td>" in found._repr_html_() and "<html" in found.save_report(tmp_path / "i.html").read_text()
    output = predicted["deformation"]
    rms = np.sqrt(np.mean((output.recorded - output.predicted) ** 2))
    assert predicted.score.rms == pytest.approx(rms, rel=1e-6) and predicted.score.rms_over_noise > 2.0
    assert predicted.to_pandas().shape == (len(output.time), 2)
    for plotted in (found, predicted, recording, quell.Shaper("zv", found.modes, rate=500)):
        assert plotted.plot() is not None
    json.dumps([found.to_dict(), predicted.to_dict(), predicted.score.to_dict()])


def test_val_a_score_tells_the_inertia_of_a_payload(joint: dict[str, np.ndarray], recording: quell.Recording) -> None:
    # Frequency and damping ratio go with the root of the inertia: that of the recording is (9/8)^2 times the model's.
    model = quell.Model("flexible_joint", natural_frequency_hz=9.0, damping_ratio=0.05 * 9.0 / 8.0)
    carries = quell.Recording.from_arrays(joint, rate=RATE, units=dict.fromkeys(joint, "rad"), payload="2 kg")
    score = quell.score(model, carries)
    own = score.with_payload
    assert own is not None and own.payload == "2 kg" and own.score.with_payload is None
    assert own.relative_inertia == pytest.approx((9.0 / 8.0) ** 2, rel=1e-3)
    assert own.score.rms_over_noise < 1.1 < score.rms_over_noise
    assert '"2 kg"' in str(score) and str(own.score) in str(score) and "2 kg" in score._repr_html_()
    assert score.to_dict()["with_payload"]["score"] == own.score.to_dict()
    assert score.rms == quell.simulate(model, carries).score.rms
    assert pickle.loads(pickle.dumps(score)).to_dict() == score.to_dict()
    assert quell.score(model, recording).with_payload is None
    with pytest.raises(quell.DiagnosisError, match="first"):
        quell.score(model, carries, first=10**6)


@pytest.fixture(scope="session")
def diagnosis(recording: quell.Recording, model: quell.Model) -> quell.Diagnosis:
    return quell.diagnose(model, recording)


def test_a_model_that_lacks_nothing_is_told_so(diagnosis: quell.Diagnosis, recording: quell.Recording) -> None:
    assert diagnosis.verdict == "no_mismatch" and diagnosis.findings == ()
    assert diagnosis.model["natural_frequency_hz"] == pytest.approx(8.0, abs=0.01)
    assert quell.score(diagnosis.model, recording).rms_over_noise < 1.1
    assert diagnosis.to_pandas().empty and "no_mismatch" in diagnosis._repr_html_()
    assert diagnosis.to_dict()["verdict"] == "no_mismatch"
    again = pickle.loads(pickle.dumps(diagnosis))
    assert again.model == diagnosis.model and again.to_dict() == diagnosis.to_dict()


def test_a_result_is_told_in_some_lines_of_a_terminal(
    joint: dict[str, np.ndarray], recording: quell.Recording, model: quell.Model, diagnosis: quell.Diagnosis
) -> None:
    found, moved = quell.identify(recording), quell.simulate_robot(np.zeros(100), rate=250)
    predicted = quell.simulate(model, recording)
    # A strain gauge that shows a tenth too much.
    wrong = {**joint, "deformation": 1.1 * joint["deformation"]}
    named = quell.diagnose(model, quell.Recording.from_arrays(wrong, rate=RATE, units=dict.fromkeys(joint, "rad")))
    assert named.findings
    told = [found, diagnosis, named, predicted, predicted["deformation"], predicted.score, moved, quell.recommend(found)]
    told += [recording, recording["deformation"], found.model, diagnosis.fit, *named.findings, *named.traces, *named.candidates]
    for one in told:
        assert repr(one).count("\n") < 15 and len(repr(one)) < 1500, repr(one)
    assert str(diagnosis) == repr(diagnosis)
    assert named.verdict in repr(named) and f"{found.modes[0].frequency_hz:.6g} +- " in repr(found)
    for finding in named.findings:
        for parameter in finding.parameters:
            assert f"{parameter.name} {parameter.value:.4g} {parameter.unit}" in repr(named)
    before, after = named.fit.before.held_out_over_noise, named.fit.after.held_out_over_noise
    assert f"{before:.3g} times the noise" in repr(named) and f"{after:.3g} after" in repr(named)


def test_the_command_line_says_the_same(
    diagnosis: quell.Diagnosis, recording: quell.Recording, model: quell.Model, tmp_path: Path
) -> None:
    folder = recording.save(tmp_path / "joint", compress=True)
    believed = model.save(tmp_path / "believed.toml")
    command = [sys.executable, "-m", "quell", "diagnose", "--model", believed, folder, "--out", tmp_path / "out"]
    subprocess.run(command, check=True, capture_output=True)
    assert json.loads((tmp_path / "out/diagnosis.json").read_text()) == diagnosis.to_dict()
    assert quell.Model.load(tmp_path / "out/model.toml") == diagnosis.model
    refused = subprocess.run([sys.executable, "-m", "quell", "inspect", "nowhere"], capture_output=True, text=True)
    assert refused.returncode == 2 and "nowhere: no such file or folder" in refused.stderr
    script = Path(sys.executable).with_name("quell")
    assert subprocess.run([script, "--version"], capture_output=True, text=True).stdout.split()[1] == quell.__version__


def test_other_threads_go_on_and_progress_is_told(recording: quell.Recording, model: quell.Model) -> None:
    told: list[tuple[float, str]] = []
    ticks, done = [], threading.Event()

    def tick() -> None:
        while not done.wait(0.001):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    quell.diagnose(model, recording, progress=lambda share, what: told.append((share, what)))
    elapsed = time.monotonic() - start
    done.set()
    thread.join()
    within = [instant for instant in ticks if start < instant < start + elapsed]
    assert len(within) >= 2 and max(np.diff(within)) < 0.9 * elapsed
    assert all(0.0 <= share <= 1.0 for share, _ in told)


def test_an_error_of_the_progress_ends_the_work(recording: quell.Recording, model: quell.Model) -> None:
    def fails(share: float, what: str) -> None:
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        quell.diagnose(model, [recording] * 3, progress=fails)


def test_an_interrupt_is_obeyed(recording: quell.Recording, model: quell.Model) -> None:
    # As soon as it says what it does, so that it is under way however slow the machine is.
    def interrupts(share: float, what: str) -> None:
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        quell.diagnose(model, [recording] * 3, progress=interrupts)


def test_an_interrupt_of_an_identification_is_obeyed() -> None:
    # A machine at work, whose mode takes a while to find.
    noise = np.random.default_rng(1).normal(size=400_000)
    pole = np.exp((-0.05 + 1j) * 2.0 * np.pi * 48.0 / 3200.0)
    work = scipy.signal.lfilter([1.0], [1.0, -2.0 * pole.real, abs(pole) ** 2], noise)
    recording = quell.Recording.from_arrays({"tip_acceleration": work}, rate=3200)
    with pytest.raises(KeyboardInterrupt):
        threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
        while True:
            quell.identify(recording)


def test_what_does_not_suit_is_refused(recording: quell.Recording, model: quell.Model, tmp_path: Path) -> None:
    still = quell.Recording.from_arrays({"tip_acceleration": np.zeros(100)}, rate=100)
    with pytest.raises(quell.IdentificationError, match="nothing vibrates|no channel|not vary"):
        quell.identify(still)
    with pytest.raises(quell.DiagnosisError, match="no channel that drives a flexible_joint"):
        quell.diagnose(model, still)
    with pytest.raises(quell.ModelError, match='did you mean "natural_frequency_hz"') as caught:
        quell.Model.from_toml('kind = "flexible_joint"\nnatural_freq_hz = 8.0\n', "arm.toml")
    assert (caught.value.file, caught.value.line, caught.value.key) == ("arm.toml", 2, "natural_freq_hz")
    with pytest.raises(quell.Error, match="cannot read the model"):
        quell.Model.load(tmp_path / "absent.toml")
