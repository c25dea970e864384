"""
Adaptive input shaping for flexible robot joints, and diagnosis of what a model of them lacks.

Numbers are in SI; a suffix such as `_hz` says where they are not. The book has a chapter on this package.
"""

from ._quell import VERSION as __version__
from .diagnosis import Diagnosis, diagnose
from .errors import (
    DiagnosisError,
    Error,
    IdentificationError,
    ModelError,
    PlanError,
    RecordingError,
    ShaperError,
    SimulationError,
)
from .filtering import AdaptiveFilter, Retuned, Setpoint
from .findings import (
    Candidate,
    Finding,
    Fit,
    FittedParameter,
    Location,
    NextMove,
    ProposedMove,
    Quality,
    Trace,
)
from .identification import Estimate, Identification, RecommendedShaper, identify
from .model import Effect, Model
from .modes import Mode
from .motion import Limits, Trajectory, plan
from .prediction import Output, PayloadScore, Prediction, Score, score, simulate
from .recommendation import Recommendation, ShaperFigures, recommend
from .recording import Channel, Recording, roles, units
from .robot import SimulatedMove, simulate_robot
from .shaping import Shaper, shape, shapers

__all__ = [
    "AdaptiveFilter",
    "Candidate",
    "Channel",
    "Diagnosis",
    "DiagnosisError",
    "Effect",
    "Error",
    "Estimate",
    "Finding",
    "Fit",
    "FittedParameter",
    "Identification",
    "IdentificationError",
    "Limits",
    "Location",
    "Mode",
    "Model",
    "ModelError",
    "NextMove",
    "Output",
    "PayloadScore",
    "PlanError",
    "Prediction",
    "ProposedMove",
    "Quality",
    "RecommendedShaper",
    "Recommendation",
    "Recording",
    "RecordingError",
    "Retuned",
    "Score",
    "Setpoint",
    "Shaper",
    "ShaperError",
    "ShaperFigures",
    "SimulatedMove",
    "SimulationError",
    "Trace",
    "Trajectory",
    "__version__",
    "diagnose",
    "identify",
    "plan",
    "recommend",
    "roles",
    "score",
    "shape",
    "shapers",
    "simulate",
    "simulate_robot",
    "units",
]
