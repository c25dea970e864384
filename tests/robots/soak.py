#!/usr/bin/env python3
"""`quell serve` for long, with everything at once: a robot over UDP, the page open in a browser, and
readers of the stream of which half never read.

    tests/robots/soak.py target/release/quell --minutes 10
    tests/robots/soak.py target/release/quell --minutes 1 --rate 4000 --joints 3

Moves are commanded all the while. It says what it measured, line by line, and ends with 1 where the
memory grows, a setpoint jumps or a tick is not accounted for. Lateness is said and not judged: it is
that of the machine, too.
"""

import argparse
import base64
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request

from campaign import TARGETS, Robot, Service, Verdict, arguments, judge_setpoints

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
# What caches and buffers of a service just started still take, s.
WARM = 30.0
# Resident memory may end above where it was when warm by so much, kB: what an allocator keeps of a
# recording, some 2 MB for each of a few at a time.
GROWTH = 8192


class Reader:
    """A reader of the stream; one that is `deaf` never reads."""

    def __init__(self, page, deaf):
        host, port = page.removeprefix("http://").rstrip("/").split(":")
        self.bytes = 0
        self.socket = socket.create_connection((host, int(port)))
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET /api/stream HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        if not deaf:
            threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        while True:
            try:
                taken = len(self.socket.recv(1 << 16))
            except OSError:
                return
            if not taken:
                return
            self.bytes += taken


def browse(page, folder):
    """The page in a browser, if there is one."""
    found = [path for path in map(shutil.which, BROWSERS) if path]
    if not found:
        print("     no browser: the page stays closed")
        return None
    command = [found[0], "--headless=new", "--no-sandbox", "--disable-gpu"]
    command += ["--remote-debugging-port=0", f"--user-data-dir={folder / 'browser'}", page]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def metric(service, name):
    with urllib.request.urlopen(f"{service.page.rstrip('/')}/metrics", timeout=10) as answer:
        lines = answer.read().decode().splitlines()
    found = [line for line in lines if line.startswith(f"quell_{name} ")]
    return float(found[0].split()[-1]) if found else 0.0


def order(service, body):
    """Commands a move; after a fault, as a busy machine makes one, moves are enabled first."""
    try:
        service.ask("/api/move", body)
    except urllib.error.HTTPError as error:
        if error.code != 409:
            raise
        service.enable()


def run(service, options):
    """Moves all joints to and fro; resident memory once a second, kB, by the time since the start, s."""
    memory, number, since = [], 0, time.monotonic()
    while time.monotonic() - since < 60.0 * options.minutes:
        service.wait_for_rest()
        for k in range(options.joints):
            body = {"joint": f"joint_{k + 1}", "target_rad": TARGETS[number % 2]}
            order(service, body)
        number += 1
        for _ in range(3):
            time.sleep(1.0)
            memory.append((time.monotonic() - since, service.memory()))
    service.wait_for_rest()
    return memory, number


def judge(verdict, service, state, memory, options):
    tick = state["tick"]
    missing = state["time_s"] * tick["rate_hz"] - tick["ticks"] - tick["skipped"]
    text = f"{tick['ticks']} ticks at {options.rate} Hz, {tick['skipped']} skipped, {tick['overruns']} overruns"
    # The clock starts some 100 ms before the first tick.
    verdict.says(0 <= missing < 0.5 * tick["rate_hz"], f"{text}; {missing:.0f} not accounted for")
    times = [1e6 * tick[f"{what}_s"] for what in ("lateness_p50", "lateness_p99", "lateness_max", "work_p99")]
    text = "lateness p50 {:.0f}, p99 {:.0f}, max {:.0f} us; work p99 {:.0f} us".format(*times)
    print(f"     {text}; real time: {tick['real_time']}; load {os.getloadavg()[0]:.1f}")
    start = memory[0][1]
    warm = [kb for at, kb in memory if at >= min(WARM, memory[-1][0] / 2)]
    last = warm[-max(len(warm) // 10, 1) :]
    text = f"resident memory {start} kB at the start, {warm[0]} warm, {max(warm)} at most, {last[-1]} at the end"
    verdict.says(min(last) - warm[0] < GROWTH, text)
    lost = metric(service, "records_lost_total")
    verdict.says(lost == 0, f"records of the tick lost: {lost:.0f}")
    link = state["link"]
    keys = ("received", "lost", "reordered", "doubled", "late", "malformed", "overflowed")
    verdict.says(link["overflowed"] == 0, "link: " + ", ".join(f"{key} {link[key]}" for key in keys))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("quell", help="the program")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--rate", type=int, default=1000, help="of the tick, Hz")
    parser.add_argument("--joints", type=int, default=1)
    parser.add_argument("--readers", type=int, default=20, help="of the stream; half of them never read")
    parser.set_defaults(sensor="link", divider=1, frequency=8.0, belief=10.0, seed=1)
    options = parser.parse_args()
    verdict = Verdict()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        folder = pathlib.Path(folder)
        service, browser = Service(options.quell, folder, options), None
        try:
            robot = Robot(service, folder, arguments(options))
            service.wait_for_rest()
            browser = browse(service.page, folder)
            readers = [Reader(service.page, deaf=k % 2 == 0) for k in range(options.readers)]
            memory, moves = run(service, options)
            state = service.state()
            judge(verdict, service, state, memory, options)
            heard = [reader.bytes for reader in readers[1::2]]
            open_ = metric(service, "streams")
            text = f"{moves} moves; {open_:.0f} streams open; each reader has had {min(heard)} to {max(heard)} bytes"
            verdict.says(min(heard) > 0, text)
            robot.end()
        finally:
            if browser:
                browser.terminate()
                browser.wait(timeout=60)
            service.process.terminate()
            service.process.wait(timeout=60)
        limits = state["joints"][0]["limits"]
        judge_setpoints(verdict, robot.log, limits, options.rate, options.joints)
    sys.exit(1 if verdict.fails else 0)


if __name__ == "__main__":
    main()
