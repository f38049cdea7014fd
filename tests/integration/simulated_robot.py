"""Simulated robot and daemon, started and ended with a test that is written in Python."""

import json
import os
import signal
import subprocess
import tempfile
import time

PATIENCE = 20.0  # s
CONFIGURATION = """[controller]
device = "slcan:{folder}/ports/can?bitrate=500000"
profile = "{folder}/profile.toml"
[lidar]
device = "serial:{folder}/ports/lidar?baud=230400"
pose = [0.10, 0.0, 0.0]
[robot]
wheel_diameter = 0.150
track_width = 0.400
[limits]
countdown = 0.0
[lcm]
enabled = {lcm_enabled}
url = "{lcm_url}"
[daemon]
state_dir = "{folder}/state"
socket = "{folder}/control"
"""


class SimulatedRobot:
    """Use with "with". The programs are those in one folder. Without a URL nothing is published. In a hurry, robot and service run
    on one clock that is faster than real time while the robot moves."""

    def __init__(self, programs, profile, seed, lcm_url="", hurry=False):
        self._lcm_url, self._hurry = lcm_url, hurry
        self.programs, self.profile, self.seed, self.running = os.path.abspath(programs), profile, seed, []
        self._folder = tempfile.TemporaryDirectory(prefix="odomcalib-live-")
        self.folder = self._folder.name

    def __enter__(self):
        os.mkdir(self.path("ports"))
        with open(self.profile, encoding="utf-8") as shipped, open(self.path("profile.toml"), "w", encoding="utf-8") as ours:
            # Robot and daemon share this machine's processors, which may stand still for longer than three life signs of 30 ms.
            ours.write(shipped.read().replace("\nperiod_ms = 30\n", "\nperiod_ms = 100\n"))
        with open(self.path("odomcalib.toml"), "w", encoding="utf-8") as file:
            file.write(CONFIGURATION.format(folder=self.folder, lcm_enabled=str(bool(self._lcm_url)).lower(),
                                            lcm_url=self._lcm_url or "memq://"))
        try:
            if self._hurry:
                self.start("odomcalib-demo", "--seed", str(self.seed), "--folder", self.folder, "--config",
                           self.path("odomcalib.toml"))
                self.wait_until(self.ready, "the service does not find the robot")
                return self
            self.start("odomcalib-sim", "--seed", str(self.seed), "--link", self.path("ports"), "--truth",
                       self.path("truth.json"))
            self.wait_until(lambda: os.path.exists(self.path("ports", "lidar")), "the simulated robot does not start")
            self.start("odomcalibd", "--config", self.path("odomcalib.toml"))
            self.wait_until(self.ready, "the daemon does not find the robot")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process in reversed(self.running):
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(5.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self._folder.cleanup()

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def start(self, program, *words):
        with open(self.path(program + ".log"), "w", encoding="utf-8") as log:
            self.running.append(subprocess.Popen([os.path.join(self.programs, program), *words], stdout=log,
                                                 stderr=log, stdin=subprocess.DEVNULL))

    def wait_until(self, holds, otherwise):
        end = time.monotonic() + PATIENCE
        while not holds():
            if time.monotonic() > end:
                logs = [name for name in os.listdir(self.folder) if name.endswith(".log")]
                raise RuntimeError("\n".join([otherwise, *(open(self.path(name), encoding="utf-8").read() for name in logs)]))
            time.sleep(0.1)

    def ctl(self, *words):
        """The command line, which has ended."""
        return subprocess.run([os.path.join(self.programs, "odomcalibctl"), "--socket", self.path("control"), *words],
                              cwd=self.folder, env={**os.environ, "COLUMNS": "80"}, check=False, text=True, timeout=60,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def ready(self):
        done = self.ctl("--json=short", "status")
        if done.returncode != 0:
            return False
        now = json.loads(done.stdout)
        return (now["state"] == "idle" and now["controller"]["state"] == "disabled" and now["robot"]["in_controller"]
                and not now["lidar"]["stale"] and not now["controller"]["stale"])
