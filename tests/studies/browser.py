# SPDX-License-Identifier: GPL-3.0-or-later
"""Headless Chromium for tests of pages, through python3-selenium; a test is skipped where these are not installed."""
import json
import os
import shutil
import tempfile
import unittest

FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage")
CHROMIUM, DRIVER = "/usr/bin/chromium", "/usr/bin/chromedriver"


def start(test_class):
    """A browser of its own profile, which ends with the class's tests."""
    try:
        from selenium import webdriver
    except ImportError as error:
        raise unittest.SkipTest("no python3-selenium") from error
    if not (os.path.exists(CHROMIUM) and os.path.exists(DRIVER)):
        raise unittest.SkipTest("no chromium and chromium-driver")
    profile = tempfile.mkdtemp(prefix="landfall-browser-")
    test_class.addClassCleanup(shutil.rmtree, profile, ignore_errors=True)
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    browser = webdriver.Chrome(service=webdriver.chrome.service.Service(DRIVER), options=options)
    test_class.addClassCleanup(browser.quit)
    browser.get("about:blank")
    requests(browser)  # what the browser's own first page asked for
    return browser


def requests(browser):
    """Addresses that were asked for since the last call, less what pages hold themselves."""
    messages = (json.loads(entry["message"])["message"] for entry in browser.get_log("performance"))
    found = (message["params"]["request"]["url"] for message in messages if message["method"] == "Network.requestWillBeSent")
    return [url for url in found if not url.startswith(("data:", "chrome:"))]


def set_width(browser, width, height=1000):
    """The page's own width, whatever the window has around it."""
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
