#!/usr/bin/env python3
"""The live page in a headless Chromium, while the simulated robot drives, in real time.

usage: tests/page/view_test.py PROGRAMS SCHEMAS PROFILE [PICTURE]     (PICTURE: the page while the robot drives, as a PNG)"""

import http.client
import json
import os
import signal
import subprocess
import sys
import time
import urllib.parse

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "integration"))

from browser import Browser  # noqa: E402
from schemas import Schemas  # noqa: E402
from simulated_robot import SimulatedRobot  # noqa: E402

DRIVE = "straight --one-way --yes --distance 0.3".split()
STOPPED = {4, 5, 6}  # protective stops: on a busy machine the simulated robot itself may be late
TRIES = 4
LEAST = 0.2  # m, of the path of 0.3 m
SCREENS = [(width, dark) for width in (1400, 400) for dark in (False, True)]

LOOK = """() => {
  const path = (figure, kind) => document.querySelector(`#${figure} > svg > path.${kind}`);
  const box = (e) => { const b = e.getBoundingClientRect(); return b.width > 0 ? [b.left, b.right] : [0, 0]; };
  return {
    state: document.getElementById("state").textContent, phase: document.getElementById("phase").textContent,
    left: document.getElementById("left").textContent,
    bar: document.getElementById("bar").firstElementChild.getBoundingClientRect().width,
    marks: (path("room", "s").getAttribute("d") || "").split("h0").length - 1,
    length: path("path", "l.b").getAttribute("d") ? path("path", "l.b").getTotalLength() : 0,
    rows: document.querySelectorAll("#rows tr").length, problem: document.getElementById("problem").textContent,
    width: [document.documentElement.scrollWidth, document.documentElement.clientWidth],
    cut: [...document.body.querySelectorAll("*")].filter((e) => !e.closest("svg") && e.tagName !== "SCRIPT")
      .filter((e) => box(e)[1] > document.documentElement.clientWidth + 1 || box(e)[0] < -1).map((e) => e.tagName),
    ink: getComputedStyle(path("path", "l.b")).stroke, paper: getComputedStyle(document.body).backgroundColor,
  };
}"""


class View:
    """`odomcalibctl view` on a free port. Use with "with"."""

    def __init__(self, robot):
        self._robot = robot

    def __enter__(self):
        program = os.path.join(self._robot.programs, "odomcalibctl")
        with open(self._robot.path("view.log"), "w", encoding="utf-8") as log:
            self.process = subprocess.Popen([program, "--socket", self._robot.path("control"), "view", "--port", "0"], text=True,
                                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=log)
        self.url = self.process.stdout.readline().strip()
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def ask(self, method, path, host=None, body=None):
        """Status, headers and text of one request."""
        place = urllib.parse.urlsplit(self.url)
        connection = http.client.HTTPConnection(place.hostname, place.port, timeout=10.0)
        try:
            connection.request(method, path, body=body, headers={"Host": host} if host else {})
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read().decode()
        finally:
            connection.close()

    def state(self):
        return json.loads(self.ask("GET", "/state.json")[2])


def requests_refused(view):
    """Looking is all that can be done, and only under this machine's own name."""
    port = urllib.parse.urlsplit(view.url).port
    asked = [("GET", "/", "localhost:%d" % port, None, 200), ("GET", "/state.json", "127.0.0.1", None, 200),
             ("GET", "/etc/passwd", None, None, 404), ("GET", "/../state.json", None, None, 404),
             ("GET", "/", "robots.example", None, 403), ("GET", "/state.json", "127.0.0.1.robots.example", None, 403),
             ("GET", "/state.json", "localhost:80@robots.example", None, 403)]
    asked += [(method, "/state.json", None, body, 405) for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS", "HEAD")
              for body in (None, "GET /state.json HTTP/1.1\r\n\r\n")]
    found = []
    for method, path, host, body, status in asked:
        got, headers, _ = view.ask(method, path, host, body)
        found += ["%s %s of %s: %d, not %d" % (method, path, host, got, status)] if got != status else []
        found += ["no policy with %d" % got] if "default-src 'none'" not in headers.get("Content-Security-Policy", "") else []
    return found


def drive(robot, browser):
    """What the page showed while the robot drove, and the exit status of the drive."""
    for _ in range(TRIES):
        robot.wait_until(robot.ready, "the controller does not come to rest")
        seen, program = [], os.path.join(robot.programs, "odomcalibctl")
        process = subprocess.Popen([program, "--socket", robot.path("control"), *DRIVE], cwd=robot.folder,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None:
            seen.append(browser.evaluate(LOOK))
            time.sleep(0.1)
        if process.returncode not in STOPPED:
            break
        print("once more, after exit status %d" % process.returncode)
    return seen, process.returncode


def faults_of_drive(seen, status):
    found = [] if status == 0 else ["the drive ends with %d" % status]
    moving = [look for look in seen if look["state"].startswith("moving")]
    found += [] if moving else ["no motion was shown"]
    found += [] if any("%" in look["left"] and look["phase"] for look in moving) else ["no progress in words"]
    found += [] if any(look["bar"] > 5 for look in moving) else ["no progress in the bar"]
    lengths = [look["length"] for look in moving]
    found += [] if lengths and max(lengths) > 50 else ["the path is not drawn while it grows: %s" % lengths]
    return found


def faults_of_state(state, schemas):
    found = schemas.faults(state, "view")
    for x, y in state["paths"]["odometry"][-1:]:
        found += ["the path ends at %g, %g" % (x, y)] if not (x > LEAST and abs(y) < 0.1) else []
    found += ["%d points of a path" % len(state["paths"]["odometry"])] if len(state["paths"]["odometry"]) < 10 else []
    found += ["%d points of the scan" % len(state["scan"])] if len(state["scan"]) < 100 else []
    names = [row["name"] for row in state["parameters"] if row["value"] is not None]
    found += ["known: %s" % names] if not {"left_wheel_diameter", "track_width", "lidar_x"} <= set(names) else []
    return found


def wait_for(browser, holds):
    for _ in range(100):
        look = browser.evaluate(LOOK)
        if holds(look):
            return look
        time.sleep(0.1)
    return look


def faults_of_screens(browser, url):
    found, papers = [], set()
    for width, dark in SCREENS:
        browser.open(url, width, dark=dark)
        look = wait_for(browser, lambda it: it["marks"] > 100 and it["rows"] > 5)
        where = "%d px%s: " % (width, ", dark" * dark)
        found += [where + "%d marks, %d rows" % (look["marks"], look["rows"])] if look["marks"] < 100 or look["rows"] < 6 else []
        found += [where + "%d px wide" % look["width"][0]] if look["width"][0] > look["width"][1] or look["width"][1] != width else []
        found += [where + "cut off: " + name for name in look["cut"]]
        found += [where + "a path of %g px" % look["length"]] if look["length"] < 50 else []
        found += [where + "asks for " + other for other in browser.requests if not other.startswith((url, "data:,"))]
        found += [where + text for text in browser.complaints]
        papers.add((dark, look["ink"], look["paper"]))
    return found + (["colours do not follow the scheme: %s" % papers] if len(papers) != 2 else [])


def faults_without_lcm(programs, profile, schemas):
    """A daemon whose LCM is off: scan and progress reach the page all the same."""
    with SimulatedRobot(programs, profile, seed=3) as robot, View(robot) as view:
        robot.wait_until(robot.ready, "the controller does not come to rest")
        program, seen = os.path.join(programs, "odomcalibctl"), []
        process = subprocess.Popen([program, "--socket", robot.path("control"), *DRIVE], cwd=robot.folder, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None:
            seen.append(view.state())
            time.sleep(0.1)
    moving = [state for state in seen if state["state"].startswith("moving")]
    found = [] if moving else ["no motion was shown"]
    found += [] if any(len(state["scan"]) > 100 for state in moving) else ["no scan"]
    found += [] if any(state["progress"] and state["progress"]["fraction"] > 0.0 for state in moving) else ["no progress"]
    known = [row["known_to"] for state in moving for row in state["parameters"] if row["name"] == "left_wheel_diameter"]
    found += [] if any(known) else ["nothing is known of a wheel while it rolls"]
    return ["without LCM: " + fault for fault in found + schemas.faults(seen[-1], "view")]


def faults_of_end(robot, view, browser):
    """The daemon goes away and comes back, and Ctrl-C ends the verb."""
    daemon = robot.running[-1]
    daemon.send_signal(signal.SIGTERM)
    daemon.wait(10.0)
    look = wait_for(browser, lambda it: "does not answer" in it["state"])
    found = [] if "does not answer" in look["state"] and "tries again" in look["problem"] else ["no word of a daemon that ended"]
    robot.start("odomcalibd", "--config", robot.path("odomcalib.toml"))
    robot.wait_until(lambda: view.state()["connected"], "the view does not find the daemon again")
    view.process.send_signal(signal.SIGINT)
    status = view.process.wait(10.0)
    return found + (["Ctrl-C ends with %d" % status] if status != 0 else [])


def main(programs, schema_folder, profile, picture=None):
    port = 20000 + os.getpid() % 20000  # nobody else's messages
    with SimulatedRobot(programs, profile, seed=3, lcm_url="udpm://239.255.76.67:%d?ttl=0" % port) as robot, View(robot) as view, \
            Browser() as browser:
        faults = requests_refused(view)
        browser.open(view.url, 1400)
        seen, status = drive(robot, browser)
        faults += faults_of_drive(seen, status)
        faults += faults_of_state(view.state(), Schemas(schema_folder))
        if picture:
            with open(picture, "wb") as file:
                file.write(browser.picture())
        faults += faults_of_screens(browser, view.url)
        faults += faults_of_end(robot, view, browser)
    faults += faults_without_lcm(programs, profile, Schemas(schema_folder))
    for fault in faults:
        print(fault)
    print("%d faults" % len(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
