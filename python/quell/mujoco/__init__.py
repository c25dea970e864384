"""
What a MuJoCo model of a robot lacks, and the model with it.

Needs MuJoCo (`pip install 'mujoco>=4'`). The book has a chapter on simulators.
"""

from ._diagnose import JointDiagnosis, RobotDiagnosis, diagnose, known

__all__ = ["JointDiagnosis", "RobotDiagnosis", "diagnose", "known"]
