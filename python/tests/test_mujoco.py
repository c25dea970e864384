"""What a MuJoCo model lacks, and the model with it: a six-axis arm in which physics is hidden."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import quell

pytest.importorskip("mujoco", reason="MuJoCo is not installed: its tests are skipped")

import mujoco  # noqa: E402
import quell.mujoco  # noqa: E402
import six_axes  # noqa: E402
from six_axes import Hidden  # noqa: E402


def over_noise(model: object, log: dict[str, quell.Recording], joint: str) -> dict[str, float]:
    """What MuJoCo leaves of each side of a joint, over the noise of its encoder."""
    noise = {"motor_position": six_axes.MOTOR, "link_position": six_axes.LINK}
    return {role: one.rms / noise[role] for role, one in quell.mujoco.simulate(model, log, joint).items()}


def diagnosed(joint: str, hidden: Hidden) -> tuple[quell.mujoco.RobotDiagnosis, quell.mujoco.Patched]:
    found = quell.mujoco.diagnose(six_axes.mjcf(), six_axes.record({joint: hidden}), joints=[joint])
    return found, quell.mujoco.patch(six_axes.mjcf(), found)


@pytest.fixture(scope="module")
def stribeck() -> tuple[quell.mujoco.RobotDiagnosis, quell.mujoco.Patched]:
    return diagnosed("shoulder", Hidden(friction=25.0, excess=0.6, stribeck=0.1))


@pytest.fixture(scope="module")
def elastic() -> tuple[quell.mujoco.RobotDiagnosis, quell.mujoco.Patched]:
    return diagnosed("elbow", Hidden(stiffness=15000.0, spring_damping=30.0))


def test_stribeck_friction_is_found_and_the_patched_model_has_it(
    stribeck: tuple[quell.mujoco.RobotDiagnosis, quell.mujoco.Patched],
) -> None:
    found, patched = stribeck
    [finding] = found["shoulder"].findings
    assert finding.effect == "stribeck_friction"
    assert finding["friction"].value == pytest.approx(25.0, rel=0.01)
    assert finding["excess"].value == pytest.approx(0.6, rel=0.02)
    assert finding["stribeck_velocity"].value == pytest.approx(0.1, rel=0.02)
    assert found["shoulder"].armature == pytest.approx(5.0, rel=0.01)
    held_out = six_axes.record({"shoulder": Hidden(friction=25.0, excess=0.6, stribeck=0.1)}, seconds=5.0, seed=7)
    before, after = (over_noise(model, held_out, "shoulder") for model in (six_axes.mjcf(), patched))
    assert after["motor_position"] < 1.1 and before["motor_position"] > 100.0
    # MJCF has Coulomb friction; what falls with the speed is a table.
    assert [law.effect for law in patched.laws] == ["stribeck_friction"] and not patched.lacks
    # The callback was taken out again.
    assert mujoco.get_mjcb_passive() is None


def test_an_elastic_joint_becomes_a_second_joint_with_its_stiffness(
    elastic: tuple[quell.mujoco.RobotDiagnosis, quell.mujoco.Patched],
) -> None:
    found, patched = elastic
    assert not found["elbow"].findings
    assert found["elbow"].stiffness == pytest.approx(15000.0, rel=0.01)
    assert found["elbow"].spring_damping == pytest.approx(30.0, rel=0.2)
    assert patched.bends == {"elbow": "elbow_bend"} and not patched.laws
    held_out = six_axes.record({"elbow": Hidden(stiffness=15000.0, spring_damping=30.0)}, seconds=5.0, seed=7)
    before, after = (over_noise(model, held_out, "elbow") for model in (six_axes.mjcf(), patched))
    assert after["motor_position"] < 1.1 and after["link_position"] < 1.1
    assert before["link_position"] > 10.0


def test_a_delay_is_the_actuators() -> None:
    found, patched = diagnosed("elbow", Hidden(delay=0.012))
    assert [finding.effect for finding in found["elbow"].findings] == ["drive_delay"]
    assert found["elbow"].findings[0]["delay"].value == pytest.approx(0.012, rel=0.005)
    assert {change.attribute for change in patched.changes} >= {"delay", "nsample"}
    held_out = six_axes.record({"elbow": Hidden(delay=0.012)}, seconds=5.0, seed=7)
    assert over_noise(patched, held_out, "elbow")["motor_position"] < 1.1


def test_the_known_torque_and_inertia_are_those_of_the_description(tmp_path: Path) -> None:
    """A pendulum of 2 kg, 0.5 m from an axis that lies, with a rotor that is not in either."""
    text = (
        '<mujoco><compiler angle="radian"/><option gravity="0 0 -9.81"/><worldbody><body>'
        '<inertial pos="0.5 0 0" mass="2" diaginertia="1e-6 1e-6 1e-6"/>'
        '<joint name="swing" axis="0 -1 0" armature="3" damping="4" frictionloss="5"/></body></worldbody></mujoco>'
    )
    time = np.arange(1500) / 500.0
    angle = 0.6 * np.sin(2.0 * time)
    recording = quell.Recording.from_arrays({"motor_position": angle}, time=time, units={"motor_position": "rad"})
    known = quell.mujoco.known(text, recording)["swing"]
    np.testing.assert_allclose(known["known_force"].array, -2.0 * 9.81 * 0.5 * np.cos(angle), atol=1e-4)
    np.testing.assert_allclose(known["inertia"].array, 2.0 * 0.25, rtol=1e-4)
    # The same of a file that names its joints.
    rows = "\n".join(f"{t!r},{q!r}" for t, q in zip(time.tolist(), angle.tolist()))
    (tmp_path / "arm.csv").write_text(f"t,q\n{rows}\n", encoding="utf-8")
    channel = 'role = "motor_position"\njoint = "swing"\nfile = "arm.csv"\ntime = "t"\ncolumn = "q"\nunit = "rad"\n'
    (tmp_path / "recording.toml").write_text(f'name = "arm"\n[[channel]]\n{channel}', encoding="utf-8")
    read = quell.mujoco.known(text, tmp_path)["swing"]
    np.testing.assert_array_equal(read["known_force"].array, known["known_force"].array)


def test_what_each_format_holds_is_written_and_the_rest_is_told(
    stribeck: tuple[quell.mujoco.RobotDiagnosis, quell.mujoco.Patched],
    elastic: tuple[quell.mujoco.RobotDiagnosis, quell.mujoco.Patched],
    tmp_path: Path,
) -> None:
    both = {**stribeck[0].joints, **elastic[0].joints}
    lab = quell.mujoco.isaac_lab(six_axes.mjcf(), both, step=0.005)
    ast.parse(lab.text)
    own = lab.values["shoulder"]
    assert own["friction"] == pytest.approx(40.0, rel=0.01) and own["dynamic_friction"] == pytest.approx(25.0, rel=0.01)
    assert own["stiffness"] == 20000.0 and own["armature"] == pytest.approx(5.0, rel=0.01)
    assert any("elasticity" in lack for lack in lab.lacks) and any("speed" in lack for lack in lab.lacks)
    links = "".join(f'<link name="{name}"/>' for name in ("base", "a", "b"))
    pairs = (("shoulder", "base", "a"), ("elbow", "a", "b"))
    joints = "".join(
        f'<joint name="{name}" type="revolute"><parent link="{up}"/><child link="{down}"/></joint>' for name, up, down in pairs
    )
    urdf = quell.mujoco.urdf(f'<robot name="arm">{links}{joints}</robot>', both)
    assert f'friction="{urdf.values["shoulder"]["friction"]!r}"' in urdf.text
    assert any("inertia of the motor" in lack for lack in urdf.lacks)
    with pytest.raises(quell.ModelError, match="shoulder"):
        quell.mujoco.urdf("<robot/>", both)
    for one in (*stribeck, *elastic, lab, urdf):
        json.dumps(one.to_dict())
        assert one._repr_html_()
    # The lines that a user gets run as they stand.
    stribeck[1].save(tmp_path)
    told = subprocess.run([sys.executable, "apply.py"], cwd=tmp_path, capture_output=True, text=True)
    assert told.returncode == 0, told.stderr


def test_every_block_of_the_chapter_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.xml").write_text(six_axes.mjcf(), encoding="utf-8")
    log = six_axes.record({"shoulder": Hidden(friction=25.0, excess=0.6, stribeck=0.1)}, seconds=5.0)
    columns = {
        name: np.stack([log[joint][role].array for joint in six_axes.NAMES], axis=1)
        for name, role in (("command", "command_position"), ("position", "motor_position"), ("torque", "torque"))
    }
    page = Path(__file__).parents[2] / "docs/src/guide/simulators.md"
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    for number, block in enumerate(blocks):
        exec(compile(block, f"{page}, block {number + 1}", "exec"), columns)
    # And the lines of the page are those that are written.
    [lines] = re.findall(r"```text\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    assert lines in Path("patched/apply.py").read_text(encoding="utf-8")


def test_what_cannot_be_is_said() -> None:
    log = six_axes.record({}, seconds=1.0)
    with pytest.raises(quell.ModelError, match="did you mean \"elbow\""):
        quell.mujoco.diagnose(six_axes.mjcf(), {"elbov": log["elbow"]})
    with pytest.raises(quell.ModelError, match="MuJoCo cannot read"):
        quell.mujoco.diagnose("<mujoco><nonsense/></mujoco>", log)
    with pytest.raises(quell.ModelError, match="no MJCF to patch"):
        quell.mujoco.patch(mujoco.MjModel.from_xml_string(six_axes.mjcf()), {})
    with pytest.raises(quell.SimulationError, match="rigid"):
        quell.mujoco.simulate(six_axes.mjcf(), log, "elbow", input="motor")


def test_joints_at_rest_are_known_to_pull_at_nothing() -> None:
    """Noise of the encoders is no acceleration of a joint that stands: the known torque is as constant as gravity."""
    known = quell.mujoco.known(six_axes.mjcf(), six_axes.record({}, seconds=4.0, seed=7))
    for joint in ("shoulder", "elbow"):
        force = known[joint]["known_force"].array
        # No joint moves in the first 0.3 s.
        assert np.std(force[:100]) < 5e-4 * np.std(force)


def test_progress_is_over_all_sides_and_a_limit_is_kept() -> None:
    log = six_axes.record({"elbow": Hidden(stiffness=15000.0, spring_damping=30.0)}, seconds=3.0)
    told: list[tuple[float, str]] = []
    quell.mujoco.diagnose(
        six_axes.mjcf(),
        log,
        joints=["elbow", "wrist"],
        time_limit=1.0,
        progress=lambda share, what: told.append((share, what)),
    )
    assert all(0.0 <= share <= 1.0 for share, _ in told)
    sides = list(dict.fromkeys(what.partition(":")[0] for _, what in told))
    assert sides == ["elbow, drive", "elbow, transmission", "wrist, drive"]
    firsts = [min(share for share, what in told if what.startswith(side)) for side in sides]
    assert firsts == sorted(firsts) and firsts[-1] >= 2.0 / 3.0
