"""What every effect shares: a name, a dimensionless size, and the places where it can change the machine."""

from dataclasses import dataclass

import numpy as np

ALL_ROLES = ("tip_position", "deformation", "tip_acceleration")
POSITION_ROLES = ("tip_position", "deformation")


@dataclass
class Setting:
    """What an effect may know when it draws its shape: typical sizes in the case at hand."""

    arm: object
    role: str
    reach: float              # largest travel of joint 1, rad
    peak: float               # typical peak deformation, rad
    durations: dict           # seconds of "train" and "test"
    dwells: list              # times of rest in the training programme

    @property
    def torque(self):
        """Typical peak torque of the spring, N m."""
        return self.arm.stiffness * self.peak

    @property
    def rate(self):
        """Typical peak rate of the deformation, rad/s."""
        return self.arm.frequency * self.peak


class Effect:
    """Base class: an effect of size `size` (about 0.05 of the spring's torque to begin with), shaped at random once."""

    name = ""
    place = ""                # transmission, link, base, sensor or environment
    catalogue = ()            # names in the catalogue of effects; empty for what no catalogue has
    shape = ""                # what its law has beside the textbook's
    equivalents = ()          # names that no motion tells from this one
    roles = ALL_ROLES         # sensors that can see it
    start, low, high = 0.05, 1e-4, 0.5
    sized = True              # whether its size is chosen by the residual that it leaves
    timed = False             # whether it knows the clock of the recording
    timestep = 2e-4
    integrator = "RK4"        # the engine's friction constraint is only true to Coulomb's law under "implicitfast"
    pairable = True           # whether it leaves a trace beside another effect

    def __init__(self, rng, setting):
        self.rng, self.setting = rng, setting
        self.draw(rng, setting)

    def draw(self, rng, setting):
        """Draws what does not scale."""

    def parameters(self, size):
        """The engine's parameters, for the record."""
        return {}

    def change_arm(self, size, arm):
        """Changes the arm before it is compiled."""

    def hook(self, size, arm, which):
        """A function of (t, dt, e, de, u, du, model) that returns torque across the joint and on the link, or None."""
        return None

    def change_chain(self, size, chain):
        """Changes the measuring chain."""


def log_uniform(rng, low, high):
    """A number whose logarithm is uniform."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
