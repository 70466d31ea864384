# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of docs/ of which scripts write some sections and people the others."""
import re


def with_sections(text, sections):
    """The page with these lines below its headings, {"Results": lines}; what stands under other headings stays."""
    for heading, lines in sections.items():
        text = re.sub(f"(## {heading}\n\n).*?(?=\n## |$(?![\\s\\S]))", lambda m, new=lines: m[1] + "\n".join(new).strip() + "\n", text,
                      flags=re.S)
    return text


def rewrite(page, sections):
    """with_sections() of a file."""
    with open(page, encoding="utf-8") as file:
        text = file.read()
    with open(page, "w", encoding="utf-8") as file:
        file.write(with_sections(text, sections))
