#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes a picture of a report, as docs/images/report.png was made.

usage: screenshot.py report.html picture.png [WIDTH [HEIGHT]]

Without HEIGHT the whole page.
"""
import sys

import browser


def main(report, picture, width="1400", height=None):
    if browser.missing():
        sys.exit(f"screenshot.py: {browser.missing()}")
    window = browser.Browser()
    try:
        window.resize(int(width))
        window.open(report)
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
