"""The four usual parameters of a joint by mujoco.sysid: rollouts of the whole arm from its commands.

Needs `pip install 'mujoco[sysid]'`.
"""

import contextlib
import io
import logging
import sys
from pathlib import Path

import mujoco
import numpy as np
from mujoco import sysid

sys.path.insert(0, str(Path(__file__).parents[2] / "python" / "tests"))
import four_parameters  # noqa: E402


def fit(mjcf, log, joint):
    """The model with friction, damping, armature and stiffness as mujoco.sysid finds them."""
    logging.getLogger("absl").setLevel(logging.ERROR)
    spec = mujoco.MjSpec.from_string(mjcf)
    spec.add_sensor(name="seen", type=mujoco.mjtSensor.mjSENS_JOINTPOS, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=joint)
    model = spec.compile()
    names = [model.joint(k).name for k in range(model.njnt)]
    stamps = log[joint]["motor_position"].stamps
    # Commands are held from sample to sample.
    time = np.arange(round(stamps[-1] / model.opt.timestep) + 1) * model.opt.timestep
    held = np.searchsorted(stamps, time + 1e-9, side="right") - 1
    commands = np.stack([log[name]["command_position"].array[held] for name in names], axis=1)
    start = sysid.create_initial_state(model, np.array([log[name]["motor_position"].array[0] for name in names]))
    # A rollout gives with each state what the sensors showed a step before it.
    seen = sysid.TimeSeries.from_names(stamps + model.opt.timestep, log[joint]["motor_position"].array[:, None], model)
    control = sysid.TimeSeries.from_control_names(time, commands, model)
    run = sysid.ModelSequences("arm", spec, "run", start, control, seen)
    # Four numbers, set as the other fit sets them.
    look = four_parameters.first_look(mjcf, log, joint)
    dof = int(model.joint(joint).dofadr[0])
    armature, damping = float(model.dof_armature[dof]), float(model.dof_damping[dof])
    first = {"frictionloss": look[0], "damping": damping, "armature": armature, "stiffness": 0.1 * damping}
    most = {"frictionloss": 50.0 * damping, "damping": 50.0 * damping, "armature": 10.0 * armature, "stiffness": 1e3 * damping}
    params = sysid.ParameterDict()
    for name, value in first.items():
        least = 1e-4 * armature if name == "armature" else 0.0
        params.add(sysid.Parameter(name, max(value, 1e-3), least, most[name], modifier=_modifier(joint, name)))
    residual = sysid.build_residual_fn(models_sequences=[run])
    # Its residuals are small numbers, which the usual tolerances take for zero.
    tight = {"gtol": 1e-15, "ftol": 1e-8, "xtol": 1e-8, "x_scale": "jac", "diff_step": 1e-2, "max_iters": 30}
    with contextlib.redirect_stdout(io.StringIO()):
        found, _ = sysid.optimize(params, residual, optimizer="scipy", verbose=False, **tight)
    return four_parameters.with_parameters(mjcf, joint, np.array([found[name].value[0] for name in four_parameters.NAMES]))


def _modifier(joint, name):
    def modify(spec, parameter):
        element, value = spec.joint(joint), float(parameter.value[0])
        element.solref_friction, element.solimp_friction = [2.0 * spec.option.timestep, 1.0], [0.9999, 0.9999, 0.001, 0.5, 2.0]
        setattr(element, name, value if name in ("frictionloss", "armature") else [value, 0.0, 0.0])

    return modify
