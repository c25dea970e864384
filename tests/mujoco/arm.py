"""The arm as a MuJoCo model: stiff motor side, flexible joint, link with the tip; slots for what effects add.

The chain of joints is (base) -> motor -> flex -> (second), all about z unless an effect says otherwise; `flex` is the
deformation of the joint itself, so native joint stiffness, damping and friction loss act across the joint.
"""

from dataclasses import dataclass, field

import mujoco
import numpy as np


@dataclass
class Arm:
    """Engine parameters in SI units; effects change a copy of them before the model is compiled."""

    lever: float
    height: float
    inertia: float              # of the link about the joint, kg m^2
    mass: float
    stiffness: float            # N m / rad across the joint
    damping: float              # N m s / rad across the joint
    motor_inertia: float
    servo: float                # bandwidth of the servo, rad/s
    home: float                 # position of joint 1 at which a programme begins, rad
    timestep: float = 2e-4
    integrator: str = "RK4"
    gravity: tuple = (0.0, 0.0, -9.81)
    density: float = 0.0        # of the surrounding fluid, kg/m^3
    friction: float = 0.0       # dry friction across the joint, N m
    friction_solver: str = ""   # MuJoCo attributes that regularise the friction
    base: str = "<!-- rigid base -->"
    base_inertia: float = 100.0
    on_link: list = field(default_factory=list)      # extra bodies on the link
    tip_on_link: bool = True
    tendons: list = field(default_factory=list)
    actuators: list = field(default_factory=list)
    laws: dict = field(default_factory=dict)         # actuator name -> its control as a function of the commanded travel
    native_stiffness: float = 1.0                    # 0 where a tendon carries the joint's spring instead
    link_inertia_taken: float = 0.0                  # moved from the link to an extra body

    @property
    def frequency(self):
        """Natural frequency of the link against a clamped motor side, rad/s."""
        return np.sqrt(self.stiffness / self.inertia)

    @property
    def damping_ratio(self):
        """Damping ratio of the link against a clamped motor side."""
        return self.damping / (2 * np.sqrt(self.stiffness * self.inertia))

    def xml(self):
        """The MJCF text."""
        com = 0.4 * self.lever
        mass = self.mass
        own = self.inertia - self.link_inertia_taken
        mass = min(mass, 0.8 * own / com ** 2)
        spin = own - mass * com ** 2
        kp, kv = self.motor_inertia * self.servo ** 2, 1.6 * self.motor_inertia * self.servo
        tip = f'<site name="tip" pos="{self.lever} 0 {self.height}"/>' if self.tip_on_link else ""
        return f"""
<mujoco>
  <compiler angle="radian" autolimits="true"/>
  <option timestep="{self.timestep}" integrator="{self.integrator}" gravity="{' '.join(map(repr, self.gravity))}" density="{self.density}"
          tolerance="1e-12" iterations="50"/>
  <worldbody>
    <body name="base">
      <inertial pos="0 0 0" mass="400" diaginertia="{self.base_inertia} {self.base_inertia} {self.base_inertia}"/>
      {self.base}
      <body name="motor">
        <inertial pos="0 0 0" mass="50" diaginertia="{self.motor_inertia} {self.motor_inertia} {self.motor_inertia}"/>
        <joint name="motor" axis="0 0 1"/>
        <body name="link">
          <inertial pos="{com} 0 {0.5 * self.height}" mass="{mass}" diaginertia="{0.1 * spin} {spin} {spin}"/>
          <joint name="flex" axis="0 0 1" stiffness="{self.stiffness * self.native_stiffness}" damping="{self.damping}"
                 frictionloss="{self.friction}" {self.friction_solver}/>
          {tip}
          {" ".join(self.on_link)}
        </body>
      </body>
    </body>
  </worldbody>
  <tendon>{" ".join(self.tendons)}</tendon>
  <actuator>
    <position name="position" joint="motor" kp="{kp}"/>
    <velocity name="velocity" joint="motor" kv="{kv}"/>
    {" ".join(self.actuators)}
  </actuator>
</mujoco>"""

    def compile(self):
        """The MuJoCo model."""
        return mujoco.MjModel.from_xml_string(self.xml())


def random_arm(rng):
    """An arm of random size: 5 to 12 Hz, damping ratio 0.02 to 0.09."""
    inertia, f, xi = rng.uniform(40, 160), rng.uniform(5.5, 12), rng.uniform(0.02, 0.09)
    w = 2 * np.pi * f
    stiffness = inertia * w ** 2
    return Arm(
        lever=round(rng.uniform(1.4, 2.2), 2), height=round(rng.uniform(0.6, 1.2), 2), inertia=inertia,
        mass=rng.uniform(40, 80), stiffness=stiffness, damping=2 * xi * np.sqrt(stiffness * inertia),
        motor_inertia=rng.uniform(30, 80), servo=2 * np.pi * rng.uniform(120, 200),
        home=0.0 if rng.random() < 0.7 else rng.uniform(-0.6, 0.6))
