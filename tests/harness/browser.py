#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A headless Chromium for the tests of reports. Run as a program it takes a screenshot, such as docs/images/report.png.

usage: browser.py report.html picture.png [WIDTH [HEIGHT]]

Without HEIGHT the screenshot shows the whole page.
"""
import base64
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.support.ui import WebDriverWait
except ImportError:
    webdriver = None

DRIVER = shutil.which("chromedriver")
CHROMIUM = shutil.which("chromium")
# WebGL is rendered in software (SwiftShader), and the browser makes no network requests of its own.
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
         "--disable-sync", "--disable-dev-shm-usage", "--hide-scrollbars", "--force-device-scale-factor=1"]


def missing():
    """The reason why no browser can be started; None if one can."""
    if webdriver is None or DRIVER is None or CHROMIUM is None:
        return "needs a browser: apt-get install chromium chromium-driver python3-selenium"
    return None


class Browser:
    """A browser with its own empty profile, which close() deletes."""

    def __init__(self, width=1400, height=1000):
        self.profile = tempfile.mkdtemp(prefix="landfall-browser-")
        self.size = None
        options = webdriver.ChromeOptions()
        options.binary_location = CHROMIUM
        for flag in [*FLAGS, f"--user-data-dir={self.profile}", f"--window-size={width},{height}"]:
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(service=Service(DRIVER, log_output=subprocess.DEVNULL), options=options)

    def close(self):
        self.driver.quit()
        shutil.rmtree(self.profile, ignore_errors=True)

    def open(self, path):
        """Opens a report and waits until it is completely drawn."""
        self.driver.get(pathlib.Path(os.path.abspath(path)).as_uri())
        self.wait("return document.body.dataset.ready === 'yes' || document.getElementById('message').textContent !== ''")

    def requests(self):
        """URLs requested since the last call, except data: and chrome: URLs."""
        messages = (json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance"))
        asked = (message["params"]["request"]["url"] for message in messages if message["method"] == "Network.requestWillBeSent")
        return [url for url in asked if not url.startswith(("data:", "chrome:"))]

    def wait(self, condition, seconds=120):
        WebDriverWait(self.driver, seconds, 0.1).until(lambda driver: driver.execute_script(condition))

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def resize(self, width, height=1000):
        """Sets the size of the page itself, excluding the window frame, for all pages until the next call; the page has been drawn again on return."""
        self.size = (width, height)
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50)));")

    def picture(self, path, clip=None):
        """Writes the whole page, or its part {x, y, width, height}, as a PNG."""
        metrics = self.driver.execute_cdp_cmd("Page.getLayoutMetrics", {})["cssContentSize"]
        area = clip or {"x": 0, "y": 0, "width": metrics["width"], "height": metrics["height"]}
        shot = self.driver.execute_cdp_cmd("Page.captureScreenshot", {
            "format": "png", "captureBeyondViewport": True, "clip": {**area, "scale": 1}})
        pathlib.Path(path).write_bytes(base64.b64decode(shot["data"]))


def main(report, picture, width="1400", height=None):
    if missing():
        sys.exit(f"browser.py: {missing()}")
    window = Browser()
    try:
        window.resize(int(width))
        begin = time.monotonic()
        window.open(report)
        print(f"drawn after {time.monotonic() - begin:.1f} s")
        clip = None if height is None else {"x": 0, "y": 0, "width": int(width), "height": int(height)}
        window.picture(picture, clip)
        for entry in window.driver.get_log("browser"):
            print(entry["level"], entry["message"], file=sys.stderr)
    finally:
        window.close()


if __name__ == "__main__":
    if not 3 <= len(sys.argv) <= 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
