#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the letters of a font, as pictures draw them, as constant tables of C++.

usage: font_glyphs.py FONT.ttf PIXELS OUTPUT.h

Letters are those of Latin 1. A letter is a box of kLetterHeight rows, from kLetterMargin pixels left of its origin to as many behind its advance;
kCoverage holds the boxes row by row, 0 (paper) to 255 (ink).
"""
import sys

from PIL import Image, ImageDraw, ImageFont

FIRST, LAST = 32, 255
MARGIN = 2


def main(path, pixels, output):
    font = ImageFont.truetype(path, int(pixels), layout_engine=ImageFont.Layout.BASIC)
    ascent, descent = font.getmetrics()
    advances, coverage = [], b""
    for code in range(FIRST, LAST + 1):
        advances.append(round(font.getlength(chr(code))))
        box = Image.new("L", (advances[-1] + 2 * MARGIN, ascent + descent))
        ImageDraw.Draw(box).text((MARGIN, ascent), chr(code), fill=255, font=font, anchor="ls")
        coverage += box.tobytes()
    lines = [", ".join(map(str, coverage[at:at + 30])) for at in range(0, len(coverage), 30)]
    text = "// SPDX-License-Identifier: GPL-3.0-or-later\n// Made by cmake/font_glyphs.py.\n#pragma once\n\n#include <array>\n#include <cstdint>\n\n"
    text += f"namespace landfall::font {{\n\ninline constexpr int kFirstLetter = {FIRST};\ninline constexpr int kLetterMargin = {MARGIN};\n"
    text += f"inline constexpr int kLetterHeight = {ascent + descent};\n"
    text += f"inline constexpr std::array<std::uint8_t, {len(advances)}> kAdvances = {{{', '.join(map(str, advances))}}};\n"
    text += f"inline constexpr std::array<std::uint8_t, {len(coverage)}> kCoverage = {{\n" + ",\n".join(lines) + "};\n\n}  // namespace landfall::font\n"
    with open(output, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
