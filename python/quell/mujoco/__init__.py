"""
What a MuJoCo model of a robot lacks, and the model with it.

Needs MuJoCo (`pip install 'mujoco>=4'`). The book has a chapter on simulators.
"""

from ._diagnose import JointDiagnosis, RobotDiagnosis, diagnose, known
from ._formats import Exported, isaac_lab, urdf
from ._laws import Law
from ._patch import patch
from ._patched import Change, Patched
from ._simulate import Simulated, simulate

__all__ = [
    "Change",
    "Exported",
    "JointDiagnosis",
    "Law",
    "Patched",
    "RobotDiagnosis",
    "Simulated",
    "diagnose",
    "isaac_lab",
    "known",
    "patch",
    "simulate",
    "urdf",
]
