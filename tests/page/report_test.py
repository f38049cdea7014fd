#!/usr/bin/env python3
"""The report as readers see it, in a headless Chromium: on a desk, on a phone, on a dark screen, on paper.

usage: tests/page/report_test.py ODOMCALIBCTL SAMPLE"""

import json
import os
import re
import subprocess
import sys
import tempfile

from browser import Browser

# px; and a name of the reader
SCREENS = [(1400, 900, "desk"), (400, 800, "phone")]
CONTRAST = 4.5  # of text and its background, as WCAG 2 asks

FUNCTIONS = """
const width = () => [document.documentElement.scrollWidth, document.documentElement.clientWidth];
const label = (e) => e.tagName + " " + (e.textContent || "").trim().slice(0, 60);
// Elements that hold more than they show, or reach beyond the page.
const cut = () => [...document.body.querySelectorAll("*")].filter((e) => !e.closest("svg")).filter((e) => {
  const box = e.getBoundingClientRect(), shown = getComputedStyle(e);
  return box.width > 0 && (box.right > document.documentElement.clientWidth + 1 || box.left < -1
    || (shown.overflowX !== "visible" && e.scrollWidth > e.clientWidth + 1));
}).map(label);
// Letters of drawings that lie outside of them, on each other, or are too small to read.
const letters = () => [...document.querySelectorAll("figure > svg")].flatMap((svg) => {
  const frame = svg.getBoundingClientRect(), texts = [...svg.querySelectorAll("text")];
  return texts.filter((t, i) => {
    const a = t.getBoundingClientRect();
    return a.left < frame.left - 1 || a.right > frame.right + 1 || a.height < 8 || texts.slice(0, i).some((o) => {
      const b = o.getBoundingClientRect();
      return a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    });
  }).map(label);
});
// A drawing without marks: dots are strokes without a length, lines have one. Marks lie within the frame.
const empty = () => [...document.querySelectorAll("figure")].filter((f) => {
  const paths = [...f.querySelectorAll(":scope > svg path.l, :scope > svg path.d")], frame = f.querySelector(":scope > svg")?.viewBox.baseVal;
  return !frame || !paths.length || paths.some((p) => {
    const box = p.getBBox();
    return (p.classList.contains("d") ? !/M[^M]*h0/.test(p.getAttribute("d")) : !(p.getTotalLength() > 1))
      || box.x < -1 || box.y < -1 || box.x + box.width > frame.width + 1 || box.y + box.height > frame.height + 1
      || getComputedStyle(p).stroke === "none";
  });
}).map(label);
const light = (c) => c.match(/[\\d.]+/g).slice(0, 3).map((v) => v / 255)
  .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)).reduce((s, v, i) => s + v * [0.2126, 0.7152, 0.0722][i], 0);
const pale = (least) => {
  const paper = light(getComputedStyle(document.body).backgroundColor);
  return [...document.body.querySelectorAll("h1,h2,p,td,th,summary,figcaption,svg text")].filter((e) => {
    const ink = light(getComputedStyle(e)[e.tagName === "text" ? "fill" : "color"]);
    return (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05) < least;
  }).map(label);
};
"""


# Elements that a reader sees without scrolling, and those that must be among them.
IN_SIGHT = """() => [...document.querySelectorAll("h1,header p,.lead,.sizes .v,.next p,.gain svg")].filter((e) => {
  const box = e.getBoundingClientRect();
  return box.width > 0 && box.top >= 0 && box.bottom <= innerHeight;
}).map((e) => e.tagName + " " + (e.className.baseVal ?? e.className) + " " + e.textContent)"""
# Questions of people, and the text that answers them on a desk without scrolling; docs/evidence/report-questions.md says where that stands.
TEXT_IN_SIGHT = """() => [...document.querySelectorAll("h1,h2,p,td,th,figcaption,figure *")].filter((e) => {
  const box = e.getBoundingClientRect();
  return box.width > 0 && box.top >= 0 && box.bottom <= innerHeight;
}).map((e) => e.textContent.replace(/\\s+/g, " ")).join("\\n")"""
QUESTIONS = {
    "Is it good?": r"^ACCEPTED WITH WARNINGS$",
    "Why not without warnings?": r"^backlash on reversals was found",
    "What do I do next?": r"^Next: ",
    "Which robot is it?": r"carrier-17",
    "Where was it driven?": r"hall 3",
    "When was it driven?": r"driven 2026-11-29, 10:25 to 10:29 UTC",
    "What was wrong with a metre?": r"A metre read [\d.]+ mm too (long|short)",
    "What is a metre off by now?": r"now [\d.]+ mm off",
    "What was wrong with a turn?": r"a full turn (read|was) [\d.]+ degrees",
    "What is a turn off by now?": r"now [\d.]+ degrees off",
    "How far off am I after some metres, before and now?": r"distance driven \[m\]",
    "Was that judged on the data that was fitted?": r"parts of the recording that the values were not fitted to",
    "What else was found?": r"play of 3\.4 deg in the left gear",
    "Who corrects that?": r"odometry with this calibration corrects it",
    "What does it do to the drive?": r"backlash: residual against reversals",
    "How large are the wheels?": r"^left wheel diameter$",
    "How wide is the track?": r"^track width$",
    "Where does the lidar sit?": r"^lidar yaw$",
    "How much did the values change?": r"^[+-][\d.]+ %$",
    "How sure are the values?": r"^repeatable to$",
    "Are they true against a tape?": r"^true to \(lidar\)$",
    "Which metre do they hang on?": r"known to \+-1\.15 % \(lidar data sheet\)",
}
TABLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs", "evidence", "report-questions.md")
UNFOLD = '() => document.querySelectorAll("details").forEach((e) => { e.open = true; })'


def ask(browser, expression):
    return browser.evaluate("() => {%s return %s; }" % (FUNCTIONS, expression))


def faults_in_sight(browser, name):
    """Verdict, robot, when, what to do; where values may be used the sentence, its two figures and the picture of the gain too."""
    seen = browser.evaluate(IN_SIGHT)
    wanted = ["H1", "Next: "] + ([] if name == "refused" else ["P lead A ", "P v", "svg"])
    return ["not in sight without scrolling: " + text for text in wanted if not any(text in one for one in seen)]


def unanswered(browser, questions):
    seen = browser.evaluate(TEXT_IN_SIGHT)
    return ["not answered without scrolling: " + question for question, answer in questions.items()
            if not re.search(answer, seen, re.M)]


def faults_of_write_backs(browser, name):
    """What was written to the controller is folded, where somebody has said it, and is not there where nobody has."""
    titles = browser.evaluate('() => [...document.querySelectorAll("summary")].map((e) => e.textContent)')
    wanted = name == "everything"
    return [] if ("Written to the controller" in titles) == wanted else ["folded: " + ", ".join(titles)]


def unlisted():
    """The table in the documents has these questions and no other."""
    with open(TABLE, encoding="utf-8") as file:
        listed = re.findall(r"^\| ([^|]+\?) \|", file.read(), re.M)
    return ["in one of test and table only: " + question for question in sorted(set(listed) ^ set(QUESTIONS))]


def faults_of_layout(browser):
    found = ["cut off: " + text for text in ask(browser, "cut()")]
    found += ["letters of a drawing: " + text for text in ask(browser, "letters()")]
    found += ["no marks: " + text for text in ask(browser, "empty()")]
    return found + ["pale: " + text for text in ask(browser, "pale(%g)" % CONTRAST)]


def faults_on_screen(browser, url, width, height, dark):
    """As it comes, and with everything unfolded."""
    browser.open(url, width, height, dark=dark)
    found = faults_of_layout(browser)
    browser.evaluate(UNFOLD)
    scroll, client = ask(browser, "width()")
    found += ["%d px of %d" % (scroll, client)] if scroll > client or client != width else []
    found += [fault for fault in faults_of_layout(browser) if fault not in found]
    found += ["asks for " + other[:80] for other in browser.requests if other != url]
    return found + browser.complaints


def words_on_paper(pdf, folder, *options):
    path = os.path.join(folder, "page.pdf")
    with open(path, "wb") as file:
        file.write(pdf)
    text = subprocess.run(["pdftotext", "-raw", *options, path, "-"], check=True, text=True, stdout=subprocess.PIPE).stdout
    return "".join(text.split())


def faults_on_paper(browser, url, folder):
    """Every cell of every table is on the paper, though folded on a screen; nothing is wider than it; and the first sheet is the
    summary: what is not folded, all of it, and nothing else."""
    browser.open(url, 718, media="print")  # A4 between its margins
    scroll, client = ask(browser, "width()")
    found = ["%d px of %d" % (scroll, client)] if scroll > client else []
    cells = browser.evaluate('() => [...document.querySelectorAll("td,th,p,h2")].map((e) => e.textContent)')
    pdf = browser.pdf()
    printed, first = words_on_paper(pdf, folder), words_on_paper(pdf, folder, "-l", "1")
    summary = browser.evaluate('() => [...document.querySelectorAll("h1,.lead,.first p,.first td")].map((e) => e.textContent)')
    found += ["not on the first sheet: " + text for text in summary if "".join(text.split()) not in first]
    found += ["more than the summary is on the first sheet"] if "Howtoreadthispage" in first else []
    return found + ["not printed: " + cell for cell in cells if "".join(cell.split()) not in printed] + (
        [] if len(cells) > 10 else ["only %d cells" % len(cells)])


def faults_of_sheet(browser, url, folder):
    """One sheet of paper, whole on every screen."""
    found = []
    for width, height, screen in SCREENS:
        browser.open(url, width, height)
        found += [screen + ": cut off: " + text for text in ask(browser, "cut()")]
        found += [screen + ": pale: " + text for text in ask(browser, "pale(%g)" % CONTRAST)]
        found += [screen + ": asks for " + other[:80] for other in browser.requests if other != url] + browser.complaints
    browser.open(url, 718, media="print")
    cells = browser.evaluate('() => [...document.querySelectorAll("td,th,p,h1,h2")].map((e) => e.textContent)')
    printed = words_on_paper(browser.pdf(), folder, "-l", "1")
    found += ["not on the one sheet: " + cell for cell in cells if "".join(cell.split()) not in printed]
    pages = subprocess.run(["pdfinfo", os.path.join(folder, "page.pdf")], check=True, text=True, stdout=subprocess.PIPE).stdout
    return found + ([] if re.search(r"^Pages: +1$", pages, re.M) else ["more than one sheet"])


def with_a_finding(calibration):
    """The same, as if backlash had been found: an effect, its picture, reasons, long names."""
    body = json.loads(json.dumps(calibration))
    body["verdict"] = "accepted_with_warnings"
    body["reasons"] = ["backlash on reversals was found; what it leaves behind has no name and is stored on the host only"] * 2
    body["robot"]["robot_id"] = "warehouse-" + "7" * 60
    body["settings"]["note"] = "epoxy floor, 40 kg of load"
    quantity = {"value": 0.06, "std": 0.0003, "unit": "rad"}
    body["effects"] = [{"name": "backlash", "parameters": {"left_play": quantity, "right_play": quantity},
                        "evidence": {"p_value": 5e-4, "held_out_before": 0.004, "held_out_after": 0.001}, "aliases": [],
                        "stored_in": "host"}]
    points = [[k / 10 - 2, 0.01 * (k % 7 - 3), 0.002 * (k % 5 - 2)] for k in range(40)]
    bins = [[k - 2, 0.01 * k - 0.02, 0.002, 0.001 * k - 0.002, 0.002] for k in range(5)]
    body["picture"]["traces"] = [{"effect": "backlash", "variable": "reversals, right less left wheel", "variable_unit": "",
                                  "residual": "heading", "residual_unit": "rad", "explained": 0.9, "points": points,
                                  "bins": bins}]
    return body


def with_everything(finding):
    """The same of a robot with a usual name, a place and a date, that drove straight on too."""
    body = {**finding, "reasons": finding["reasons"][:1], "settings": {**finding["settings"], "place": "hall 3"},
            "robot": {**finding["robot"], "robot_id": "carrier-17"},
            "driven": {"begin": "2026-11-29T10:25:00Z", "end": "2026-11-29T10:29:00Z"}}
    figures = {name: {"value": value, "interval": [0.9 * value, 1.1 * value]} for name, value in (("before", 0.022), ("after", 0.0004))}
    body["drive_errors"] = [{"name": "straight_metre_length", "unit": "m", "stretches": 12, "geometry": None, "noise_floor": 0.0003,
                             **figures}] + body["drive_errors"]
    return body


def a_history():
    """Of the robot with everything: written and proven, taken back, written again."""
    def entry(number, action, proven, before, after):
        lengths = ("left_wheel_diameter", "right_wheel_diameter", "track_width")
        return {"id": "%04d" % number, "time": 1795953600000000 + number * 86400000000, "action": action, "outcome": "committed",
                "before": dict(zip(lengths, before)), "after": dict(zip(lengths, after)), "device": "0x29c/0x2001/1234567",
                "user": 1000, "user_name": "commissioning", "robot_id": "carrier-17", "proven": proven,
                "restores": "0001" if action == "rollback" else ""}
    old, new = (0.15, 0.15, 0.4), (0.153056, 0.154423, 0.394106)
    figures = {"straight_metre_length": 0.0221, "straight_metre_heading": 0.004, "full_turn_heading": 0.065}
    entries = [entry(1, "apply", True, old, new), entry(2, "rollback", False, new, old), entry(3, "apply", True, old, new)]
    for one in entries[::2]:
        one["trial"] = {"before": figures, "after": {name: value / 20 for name, value in figures.items()}}
    return {"format": "odomcalib-history/1", "calibrations": "/var/lib/odomcalib/calibrations", "entries": entries[::-1]}


def write_reports(program, sample, folder):
    """Names and addresses of pages, one for each verdict."""
    def ctl(*words):
        return subprocess.run([program, *words], cwd=folder, check=False, text=True, stdout=subprocess.DEVNULL).returncode
    ctl("solve", sample, "--out", "good.json")
    with open(os.path.join(folder, "good.json"), encoding="utf-8") as file:
        good = json.load(file)
    refused = {**good, "verdict": "refused", "reasons": ["the motion does not separate the parameters"], "picture": None,
               "drive_errors": [], "detectable": []}
    with open(os.path.join(folder, "history.json"), "w", encoding="utf-8") as file:
        json.dump(a_history(), file)
    pages = []
    finding = with_a_finding(good)
    for name, body in (("good", good), ("finding", finding), ("everything", with_everything(finding)), ("refused", refused)):
        with open(os.path.join(folder, name + ".json"), "w", encoding="utf-8") as file:
            json.dump(body, file)
        written = ["--history", "history.json"] if name == "everything" else []
        if ctl("report", name + ".json", "--html", name + ".html", *written) != 0:
            sys.exit("no report of " + name)
        pages.append((name, "file://" + os.path.join(folder, name + ".html")))
    return pages


def write_sheets(program, folder):
    """Names and addresses of the pages of one sheet; a refusal has no certificate."""
    def ctl(*words):
        return subprocess.run([program, "report", *words], cwd=folder, check=False, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL).returncode
    statuses = [ctl("good.json", "--sheet", "sheet.html"), ctl("finding.json", "--sheet", "found.html"),
                ctl("finding.json", "--certificate", "certificate.html"), ctl("refused.json", "--certificate", "none.html")]
    if statuses != [0, 0, 0, 3] or os.path.exists(os.path.join(folder, "none.html")):
        sys.exit("sheets and certificates end with %s" % statuses)
    return [(name, "file://" + os.path.join(folder, name + ".html")) for name in ("sheet", "found", "certificate")]


def plant(folder):
    """A page with one fault of each kind that is looked for."""
    path = os.path.join(folder, "planted.html")
    with open(path, "w", encoding="utf-8") as file:
        file.write('<!DOCTYPE html><meta name="viewport" content="width=device-width"><body style="background:#fff">'
                   '<img src="http://localhost:1/x.png"><script>nobody.knows()</script><p style="color:#ccc">pale</p>'
                   '<table><tr><td style="white-space:nowrap">' + "wide " * 200 + "</td></tr></table>"
                   '<div style="width:90px;overflow-x:hidden;white-space:nowrap">hidden behind its edge, all of this</div>'
                   '<figure><svg viewBox="0 0 100 50"><path class="l" d="M0 0h90" stroke="none"/><text x="1" y="20">1</text>'
                   '<text x="1" y="20">2</text></svg></figure>')
    return "file://" + path


def blind_spots(browser, folder):
    """What of the planted faults is not seen."""
    url = plant(folder)
    seen = "\n".join(faults_on_screen(browser, url, 400, 800, False) + faults_in_sight(browser, "planted")
                     + unanswered(browser, QUESTIONS))
    return ["a planted fault is not seen: " + kind for kind in
            ("px of 400", "cut off: DIV hidden", "cut off: TD wide", "letters of a drawing", "no marks", "pale: P pale",
             "asks for http://localhost", "script error", "not in sight without scrolling: H1",
             "not answered without scrolling: Is it good?") if kind not in seen]


def main(program, sample):
    faults = unlisted()
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        faults += blind_spots(browser, folder)
        for name, url in write_reports(os.path.abspath(program), os.path.abspath(sample), folder):
            for width, height, screen in SCREENS:
                for dark in (False, True):
                    where = "%s, %s%s: " % (name, screen, ", dark" * dark)
                    faults += [where + fault for fault in faults_on_screen(browser, url, width, height, dark)]
                browser.open(url, width, height)
                faults += ["%s, %s: %s" % (name, screen, fault) for fault in faults_in_sight(browser, name)]
                if (name, screen) == ("everything", "desk"):
                    faults += unanswered(browser, QUESTIONS)
            faults += [name + ": " + fault for fault in faults_of_write_backs(browser, name)]
            faults += [name + ", paper: " + fault for fault in faults_on_paper(browser, url, folder)]
        for name, url in write_sheets(os.path.abspath(program), folder):
            faults += [name + ": " + fault for fault in faults_of_sheet(browser, url, folder)]
    for fault in faults:
        print(fault)
    print("%d faults" % len(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
