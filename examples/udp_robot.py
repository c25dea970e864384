#!/usr/bin/env python3
"""The smallest robot that Quell can command over UDP: one joint that goes where it is told.

python3 examples/udp_robot.py [PORT] [KEY]
"""

import hmac
import json
import socket
import sys
import time

quell = ("127.0.0.1", int(sys.argv[1]) if len(sys.argv) > 1 else 7871)
key = sys.argv[2].encode() if len(sys.argv) > 2 else None
link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
link.bind(("127.0.0.1", 0))
link.setblocking(False)


def send(said):
    if key is None:
        link.sendto(json.dumps(said).encode(), quell)
        return
    said["seq"] = time.time_ns() // 1000
    body = json.dumps(said)[:-1].encode()
    sig = hmac.new(key, body, "sha256").hexdigest()
    link.sendto(body + b',"sig":"' + sig.encode() + b'"}', quell)


position, seq = 0.0, 0
while True:
    try:
        while True:
            setpoint = json.loads(link.recv(2048))
            if not 0 <= seq - setpoint["seq"] < 1000:  # overtaken on its way; a service that starts counts anew
                position, seq = setpoint["position"], setpoint["seq"]  # give it to your drive
    except (BlockingIOError, ConnectionRefusedError):
        pass  # nothing has come, or nobody listens yet
    # Read your encoder here, and your second sensor, if there is one: "deformation", "link_position", "tip_position".
    send({"t": time.monotonic(), "joint": "joint_1", "motor_position": position})
    time.sleep(0.001)
