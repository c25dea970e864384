"""Moves of joint 1: jerk-limited S-curves from rest to rest, and programmes of them."""

import numpy as np


def s_curve_phases(distance, velocity, acceleration, jerk):
    """Durations (jerk, constant acceleration, cruise) of the shortest symmetric S-curve over `distance` > 0.

    Limits are lowered where the move is too short to reach them:
    distance = v (t_v + t_a + 2 t_j) with v = a (t_a + t_j), a = j t_j.
    """
    t_j = min(acceleration / jerk, np.sqrt(velocity / jerk), np.cbrt(distance / (2 * jerk)))
    a = jerk * t_j
    # From a (t_a + t_j) <= v and, without cruise, a (t_a + t_j) (t_a + 2 t_j) <= distance.
    t_a = max(0.0, min(velocity / a - t_j, -1.5 * t_j + np.sqrt(0.25 * t_j ** 2 + distance / a)))
    v = a * (t_a + t_j)
    return t_j, t_a, max(0.0, distance / v - t_a - 2 * t_j)


def s_curve(times, start, distance, velocity, acceleration, jerk):
    """Position, velocity and acceleration at `times` of one move that begins at time `start` from 0; also its duration."""
    t_j, t_a, t_v = s_curve_phases(abs(distance), velocity, acceleration, jerk)
    j = np.copysign(jerk, distance)
    lengths = [t_j, t_a, t_j, t_v, t_j, t_a, t_j]
    jerks = [j, 0, -j, 0, -j, 0, j]
    t = np.clip(times - start, 0.0, sum(lengths))
    position, speed, accel = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    p = v = a = begin = 0.0
    for length, slope in zip(lengths, jerks):
        inside = (t >= begin) & (t <= begin + length)
        s = t[inside] - begin
        position[inside] = p + v * s + a * s ** 2 / 2 + slope * s ** 3 / 6
        speed[inside] = v + a * s + slope * s ** 2 / 2
        accel[inside] = a + slope * s
        s = length
        p, v, a = p + v * s + a * s ** 2 / 2 + slope * s ** 3 / 6, v + a * s + slope * s ** 2 / 2, a + slope * s
        begin += length
    after = times > start + begin
    position[after], speed[after], accel[after] = distance, 0.0, 0.0
    return position, speed, accel, begin


def programme(rng, kind, reach, peak_acceleration):
    """A list of moves: dicts with start, distance and limits; and the duration and the time at which recording begins.

    kind: "train" (3 to 4 moves), "test" (2 to 3), "few" (1 to 2), "rich" (6 to 8). All stay within [0, reach] and the first is long.
    """
    count = {"train": rng.integers(3, 5), "test": rng.integers(2, 4), "few": rng.integers(1, 3), "rich": rng.integers(6, 9)}[kind]
    targets = [reach]
    while len(targets) < count:
        target = rng.uniform(0.0, 0.9 * reach) if rng.random() < 0.8 else reach
        if abs(target - targets[-1]) > 0.2 * reach:
            targets.append(target)
    clock, position, moves = 0.3, 0.0, []
    for target in targets:
        acceleration = peak_acceleration * rng.uniform(0.6, 1.0)
        move = {"start": clock, "distance": target - position, "velocity": rng.uniform(0.45, 1.2),
                "acceleration": acceleration, "jerk": acceleration / rng.uniform(0.03, 0.12)}
        phases = s_curve_phases(abs(move["distance"]), move["velocity"], acceleration, move["jerk"])
        clock += 4 * phases[0] + 2 * phases[1] + phases[2] + rng.uniform(0.5, 1.3)
        position = target
        moves.append(move)
    return {"moves": moves, "duration_s": clock + rng.uniform(0.2, 0.6)}


def reference(moves, times):
    """Commanded position, velocity and acceleration of a list of moves at `times`."""
    total = np.zeros((3, times.size))
    for move in moves:
        total += s_curve(times, move["start"], move["distance"], move["velocity"], move["acceleration"], move["jerk"])[:3]
    return total
