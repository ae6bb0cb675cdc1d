#!/usr/bin/env python3
"""Screenshots of HTML reports in headless Chromium, and what their consoles and networks say. A developer's tool.

    scripts/look_at_report.py demo/*.html                    1280x720 and 1920x1080, light and dark, into /tmp/look
    scripts/look_at_report.py page.html --do 'move 400 300'  with the pointer there
    scripts/look_at_report.py page.html --do 'drag 300 400 500 400' --do 'wait 0.5' --size 1280x720 --theme dark
    scripts/look_at_report.py page.html --do 'run document.title'  prints the value of an expression

Ends with 1 if a page logged an error or a warning, threw, or asked for anything outside of itself.
"""
import argparse
import base64
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time


class Browser:
    """Chromium behind a pair of pipes (its debugging protocol, one JSON message after the other, ended by NUL)."""

    def __init__(self, program, flags=""):
        to_browser, self.output = os.pipe()
        self.input, from_browser = os.pipe()
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        # Chromium reads from 3 and writes to 4.
        command = (f'exec 3<&{to_browser} 4>&{from_browser}; exec "$0" --headless --no-sandbox --disable-gpu '
                   '--no-first-run --disable-background-networking --disable-component-update --disable-sync '
                   f'--hide-scrollbars {flags} --user-data-dir="{self.profile.name}" --remote-debugging-pipe about:blank 2>/dev/null')
        self.process = subprocess.Popen(["bash", "-c", command, program], pass_fds=(to_browser, from_browser))
        os.close(to_browser)
        os.close(from_browser)
        self.buffer, self.last, self.session, self.complaints = b"", 0, None, []

    def receive(self):
        while b"\0" not in self.buffer:
            part = os.read(self.input, 1 << 20)
            if not part:
                raise RuntimeError("the browser ended")
            self.buffer += part
        message, self.buffer = self.buffer.split(b"\0", 1)
        message = json.loads(message)
        self.listen(message)
        return message

    def listen(self, message):
        method, data = message.get("method", ""), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = data["exceptionDetails"]
            self.complaints.append("exception: " + details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and data["type"] in ("error", "warning", "assert"):
            texts = [str(a.get("value", a.get("description"))) for a in data["args"]]
            self.complaints.append("console: " + " ".join(texts))
        elif method == "Log.entryAdded" and data["entry"]["level"] in ("error", "warning"):
            # What Chromium says about drawing in three dimensions without a graphics card is not about the page.
            if not any(word in data["entry"]["text"] for word in ("WebGL", "GL Driver", "Canvas2D")):
                self.complaints.append("log: " + data["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            url = data["request"]["url"]
            if not url.startswith(("file:", "data:", "blob:")):
                self.complaints.append("request: " + url)

    def call(self, method, **params):
        self.last += 1
        message = {"id": self.last, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.output, json.dumps(message).encode() + b"\0")
        while (answer := self.receive()).get("id") != self.last:
            pass
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        return answer["result"]

    def open(self, url, width, height, theme, scale=1):
        self.session = None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=False)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
        started = time.monotonic()
        self.call("Page.navigate", url=url)
        while self.value("document.readyState") != "complete":
            time.sleep(0.02)
        seconds = time.monotonic() - started
        self.wait(0.4)
        return seconds

    def value(self, expression):
        return self.call("Runtime.evaluate", expression=expression, returnByValue=True)["result"].get("value")

    def wait(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.value("1")
            time.sleep(0.05)

    def mouse(self, kind, x, y, buttons=0):
        button = "left" if kind != "mouseMoved" or buttons else "none"
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=buttons, clickCount=1)

    def act(self, text):
        word, _, rest = text.strip().partition(" ")
        if word == "run":
            print("  ", rest, "=", self.value(rest))
            return
        numbers = [float(part) for part in rest.split()]
        if word == "wait":
            self.wait(numbers[0])
        elif word == "move":
            self.mouse("mouseMoved", *numbers)
        elif word == "click":
            self.mouse("mouseMoved", *numbers)
            self.mouse("mousePressed", *numbers, buttons=1)
            self.mouse("mouseReleased", *numbers)
        elif word == "drag":
            x0, y0, x1, y1 = numbers
            self.mouse("mouseMoved", x0, y0)
            self.mouse("mousePressed", x0, y0, buttons=1)
            for part in (0.3, 0.6, 1.0):
                self.mouse("mouseMoved", x0 + part * (x1 - x0), y0 + part * (y1 - y0), buttons=1)
            self.mouse("mouseReleased", x1, y1)
        else:
            raise SystemExit(f"unknown action '{word}': move, click, drag, wait or run")
        self.wait(0.3)

    def picture(self, file, whole, element):
        if element:
            box = json.loads(self.value(
                f"(() => {{ const r = document.querySelector({json.dumps(element)}).getBoundingClientRect();"
                " return JSON.stringify({x: r.x + scrollX, y: r.y + scrollY, width: r.width, height: r.height}); })()"))
            data = self.call("Page.captureScreenshot", captureBeyondViewport=True, clip={**box, "scale": 1})
        elif whole:
            size = self.call("Page.getLayoutMetrics")["cssContentSize"]
            clip = {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}
            data = self.call("Page.captureScreenshot", captureBeyondViewport=True, clip=clip)
        else:
            data = self.call("Page.captureScreenshot")
        file.write_bytes(base64.b64decode(data["data"]))

    def close(self):
        self.session = None
        self.call("Browser.close")
        self.process.wait()
        self.profile.cleanup()


def look(browser, page, size, theme, arguments):
    width, height = (int(part) for part in size.split("x"))
    seconds = browser.open(f"{page.resolve().as_uri()}#{arguments.hash}", width, height, theme, arguments.scale)
    for action in arguments.do:
        browser.act(action)
    file = arguments.out / f"{page.stem}-{size}-{theme}.png"
    browser.picture(file, arguments.whole, arguments.element)
    print(f"{file}  (loaded in {seconds:.2f} s)")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="+", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/look"))
    parser.add_argument("--size", action="append", help="WIDTHxHEIGHT, repeatable")
    parser.add_argument("--theme", action="append", choices=["light", "dark"])
    parser.add_argument("--whole", action="store_true", help="the whole page instead of the first screen")
    parser.add_argument("--element", help="CSS selector: only this element")
    parser.add_argument("--scale", type=float, default=1, help="pixels of the picture per pixel of the page")
    parser.add_argument("--hash", default="", help="for example event=3")
    parser.add_argument("--do", action="append", default=[], help="an action before the picture, repeatable")
    parser.add_argument("--browser", default="chromium")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)

    browser = Browser(arguments.browser)
    try:
        for page in arguments.pages:
            for size in arguments.size or ["1280x720", "1920x1080"]:
                for theme in arguments.theme or ["light", "dark"]:
                    look(browser, page, size, theme, arguments)
    finally:
        browser.close()
    for complaint in browser.complaints:
        print(complaint, file=sys.stderr)
    return 1 if browser.complaints else 0


if __name__ == "__main__":
    sys.exit(main())
