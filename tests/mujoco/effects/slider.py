"""A spring and a damper side by side that slide together when their torque exceeds a level."""

import math


class Slider:
    """f = clamp(k z + c z', -level, level); k = level / length, c = k time_constant; exact over a step of constant rate."""

    def __init__(self, level, length, time_constant):
        self.level, self.k, self.tau, self.z = level, level / length, time_constant, 0.0

    def torque(self, rate, dt):
        """Torque against the rate in the middle of the step; moves the slider on by the step."""
        old = self.z
        held = self.k * (old + 0.5 * dt * rate + self.tau * rate)
        if abs(held) <= self.level:
            self.z = old + rate * dt
            return held
        # It slides: the spring relaxes towards the level over the damper.
        end = math.copysign(self.level / self.k, held)
        self.z = end + (old - end) * math.exp(-dt / self.tau)
        return math.copysign(self.level, held)
