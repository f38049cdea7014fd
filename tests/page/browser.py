"""A headless Chromium, spoken to over its DevTools pipe: JSON messages that end in NUL, no sockets, no packages."""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

PATIENCE = 60.0  # s for one answer


class Browser:
    """Use with "with". One tab; what it asks of the network and what its console says is kept."""

    def __enter__(self):
        program = shutil.which("chromium") or shutil.which("chromium-browser")
        if not program:
            raise RuntimeError("no chromium: apt-get install chromium")
        # Processes of the browser may outlive the one that was started, and write into the profile while it is removed.
        self._profile = tempfile.TemporaryDirectory(prefix="odomcalib-browser-", ignore_cleanup_errors=True)
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()
        # The browser reads its descriptor 3 and writes its 4.
        words = ["bash", "-c", 'exec "$@" 3<&%d 4>&%d' % (to_browser, from_browser), "browser", program, "--headless=new",
                 "--remote-debugging-pipe", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
                 "--disable-background-networking", "--disable-component-update", "--disable-extensions",
                 "--force-color-profile=srgb", "--hide-scrollbars", "--user-data-dir=" + self._profile.name, "about:blank"]
        with open(os.path.join(self._profile.name, "log"), "wb") as log:
            self._process = subprocess.Popen(words, pass_fds=(to_browser, from_browser), stdin=subprocess.DEVNULL, stdout=log,
                                             stderr=log)
        os.close(to_browser)
        os.close(from_browser)
        self._number, self._rest, self._session = 0, b"", None
        self.requests, self.complaints, self._events = [], [], []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(domain + ".enable")
        return self

    def __exit__(self, *_):
        self._process.terminate()
        try:
            self._process.wait(10.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._in)
        os.close(self._out)
        self._profile.cleanup()

    def call(self, method, **parameters):
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._out, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + PATIENCE
        while True:
            answer = self._receive(end, method)
            if answer.get("id") != self._number:
                self._note(answer)
            elif "error" in answer:
                raise RuntimeError("%s: %s" % (method, answer["error"]))
            else:
                return answer["result"]

    def open(self, url, width, height=900, dark=False, media="screen"):
        """Loads a page; what is noted is of this page."""
        self.requests, self.complaints, self._events = [], [], []
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
        self.call("Emulation.setEmulatedMedia", media=media,
                  features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        failed = self.call("Page.navigate", url=url).get("errorText")
        if failed:
            raise RuntimeError("%s: %s" % (url, failed))
        end = time.monotonic() + PATIENCE
        while "Page.loadEventFired" not in self._events:
            self._note(self._receive(end, url))

    def evaluate(self, script):
        """The value of a script, which is a function without arguments."""
        answer = self.call("Runtime.evaluate", expression="(%s)()" % script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(json.dumps(answer["exceptionDetails"])[:600])
        return answer["result"].get("value")

    def pdf(self):
        """A4, as the print dialogue makes it."""
        self.call("Emulation.setEmulatedMedia", media="print", features=[])
        return base64.b64decode(self.call("Page.printToPDF", paperWidth=8.27, paperHeight=11.69, printBackground=True)["data"])

    def picture(self, height=None):
        """PNG of the whole page, or of its top."""
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        clip = {"x": 0, "y": 0, "width": size["width"], "height": min(size["height"], height or size["height"]), "scale": 1}
        answer = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip=clip)
        return base64.b64decode(answer["data"])

    def _receive(self, end, what):
        while b"\0" not in self._rest:
            if not select.select([self._in], [], [], max(0.0, end - time.monotonic()))[0]:
                raise RuntimeError("the browser does not answer: " + what)
            part = os.read(self._in, 1 << 20)
            if not part:
                raise RuntimeError("the browser ended: " + what)
            self._rest += part
        message, self._rest = self._rest.split(b"\0", 1)
        return json.loads(message)

    def _note(self, event):
        method, parameters = event.get("method"), event.get("params", {})
        self._events.append(method)
        if method == "Network.requestWillBeSent":
            self.requests.append(parameters["request"]["url"])
        elif method == "Runtime.exceptionThrown":
            self.complaints.append("script error: %s" % json.dumps(parameters["exceptionDetails"])[:300])
        elif method == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
            self.complaints.append("%s %s" % (parameters["entry"].get("text"), parameters["entry"].get("url", "")))
        elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
            self.complaints.append("console: %s" % json.dumps(parameters["args"])[:300])
