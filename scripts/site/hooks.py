# SPDX-License-Identifier: GPL-3.0-or-later
"""MkDocs hooks of the site: the version in its heading, the navigation of docs/README.md, titles as the texts of links, and Markdown as GitHub reads it.

docs/README.md is the one list of the pages: each of its level-2 headings is a section of the navigation, each link below it a page, in
order. A folder's README.md, where it is linked, adds the pages of its folder in the order of its own links.
"""
import json
import os
import re
import sys

from pymdownx import slugs

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.abspath(os.path.join(HERE, "..", ".."))
sys.path.insert(0, HERE)
# pylint: disable=wrong-import-position
import keys

INDEX = "docs/README.md"
LINK = re.compile(r"(?<!!)\[[^\[\]]*\]\(([^()\s#]+\.md)(?:#[^()\s]*)?\)")
ANY_LINK = re.compile(r"(?<!!)\[([^\[\]]*)\]\(([^():\s#]+(?:#[^()\s]*)?)\)")
ITEM = re.compile(r" *(?:[-*]|\d+\.) ")
# A comment of a page: for the tests of its commands, or for the site: <!-- site: DIRECTIVE -->.
SITE = re.compile(r"<!-- site: (.*) -->")


def version():
    with open(os.path.join(ROOT, "CMakeLists.txt"), encoding="utf-8") as file:
        return re.search(r"project\(landfall VERSION (\S+)", file.read())[1]


def read(page):
    with open(os.path.join(os.environ["LANDFALL_PAGES"], page), encoding="utf-8") as file:
        return file.read()


def linked_pages(page, text):
    """The pages that a text of `page` links to, in order."""
    return list(dict.fromkeys(os.path.normpath(os.path.join(os.path.dirname(page), target)) for target in LINK.findall(text)))


def title_of(page):
    """The page's first heading."""
    return re.search(r"(?m)^# (.*)$", read(page))[1].replace("`", "")


def titled(page):
    """An entry of the navigation."""
    return {title_of(page): page}


def with_folder(page, listed):
    """A page, or, for the README.md of a folder, a section of this page and the pages of the folder that no other line lists."""
    folder = os.path.dirname(page)
    if os.path.basename(page) != "README.md" or folder in ("", "docs"):
        return titled(page)
    inner = [other for other in linked_pages(page, read(page)) if os.path.dirname(other) == folder and other not in listed and other != page]
    [(title, _)] = titled(page).items()
    return {title: [page, *map(titled, inner)]}


def sections():
    """[(heading, text)] of the tables of docs/README.md."""
    for section in re.split(r"(?m)^## ", read(INDEX))[1:]:
        heading, _, text = section.partition("\n")
        if "|---|" in text:
            yield heading.strip(), text


def navigation():
    listed = {page for _, text in sections() for page in linked_pages(INDEX, text)}
    entries, seen = [{"landfall": "README.md"}, {"All pages": INDEX}], {"README.md", INDEX}
    for heading, text in sections():
        found = [page for page in linked_pages(INDEX, text) if page not in seen]
        seen |= set(found)
        entries.append({heading: [with_folder(page, listed) for page in found]})
    return entries


def on_config(config):
    config["site_name"] += f" {version()}"
    config["nav"] = navigation()
    config["mdx_configs"]["toc"] = {"slugify": slugs.slugify(case="lower"), "permalink": True}
    return config


def without_comments(text):
    """The text without the comments for tests; a comment for the site becomes what it holds."""
    kept, inside, fenced = [], False, False
    for line in text.split("\n"):
        fenced ^= line.lstrip().startswith("```")
        directive = SITE.fullmatch(line)
        if directive and not fenced:
            kept.append(directive[1])
        elif not fenced and (inside or line.startswith("<!--")):
            inside = "-->" not in line
        else:
            kept.append(line)
    return "\n".join(kept)


def starts_list(line, before):
    """Whether a line is an item that Python's Markdown would take for text of the paragraph above."""
    return ITEM.match(line) and before.strip() and not ITEM.match(before) and not before.startswith(" ")


def with_lists(text):
    """The text as Python's Markdown needs it for what GitHub reads: an empty line before a list, and four spaces for each two inside of it."""
    kept, fenced, in_list, shift, has_blocks = [], False, False, 0, False
    for line in text.split("\n"):
        before = kept[-1] if kept else ""
        if not fenced:
            in_list = bool(ITEM.match(line)) or in_list and (not line.strip() or line.startswith(" "))
            lead = len(line) - len(line.lstrip())
            shift = lead // 2 * 4 - lead if in_list else 0
            kept += [""] if starts_list(line, before) or ITEM.match(line) and has_blocks else []
            has_blocks = in_list and not ITEM.match(line) and (has_blocks or not line.strip())
        fenced ^= line.lstrip().startswith("```")
        kept.append(" " * shift + line if line.strip() else line)
    return "\n".join(kept)


def with_titles(text, page):
    """The text without links to folders and hidden files of the repository, which the site does not hold; the name of a page as the text of a
    link becomes its title."""
    def shown(link):
        target, _, anchor = link[2].partition("#")
        path = os.path.normpath(os.path.join(os.path.dirname(page), target))
        if path.startswith(".") or os.path.isdir(os.path.join(ROOT, path)):
            return link[1]
        is_name = link[1].endswith((".md", "/")) and path.endswith(".md")
        return f"[{title_of(path)}]({link[2]})" if is_name else link[0]
    return ANY_LINK.sub(shown, text)


def with_headings(text):
    """The text with a heading for the second column of each table that names only the first one."""
    return re.sub(r"(?m)^(\| [^|\n]+ \|) \|(?=\n\|[-|]+\|$)", r"\1 description |", text)


def on_page_markdown(markdown, page, **_):
    return with_titles(with_headings(with_lists(without_comments(markdown))), page.file.src_path)


STAGES = {f"{keys.FOLDER}/{page}.html": kind for kind, page in keys.PAGES.items()}
ROW = re.compile(r"(?m)^\| \[[^\]]*\]\(([^()\s#]+\.md)\) \| (.*) \|$")
WORD = re.compile(r"\w[\w.+]*")


def subjects():
    """{path of a user page on the site: the words of its title, four times, and of what docs/README.md says about it}. The search prefers them to any text."""
    found = {}
    for link, about in ROW.findall(read(INDEX)):
        page = os.path.normpath(os.path.join(os.path.dirname(INDEX), link))
        if page.startswith("docs/user/"):
            found[re.sub(r"README\.md$", "index.md", page)[:-len("md")] + "html"] = WORD.findall(f"{4 * (title_of(page) + ' ')} {LINK.sub('', about)}".lower())
    return found


def in_search(entry, words):
    """An entry of the search, with the subject of its page. That of a configuration key has the last part of the key too, so that range_sigma_m
    finds noise.range_sigma_m; a key without a dot gets its stage, as in studies, so that footprint finds no footprint_m before the page that explains it."""
    page, _, anchor = entry["location"].partition("#")
    if not anchor and page in words:
        return {**entry, "tags": words[page]}
    if not anchor or page not in STAGES or " " in entry["title"]:
        return entry
    name = entry["title"]
    return {**entry, "title": name if "." in name else f"{STAGES[page]}.{name}", "text": f"{entry['text']} {name.split('.')[-1]}"}


def on_post_build(config):
    path = os.path.join(config["site_dir"], "search", "search_index.json")
    with open(path, encoding="utf-8") as file:
        index = json.load(file)
    words = subjects()
    index["docs"] = [in_search(entry, words) for entry in index["docs"] if not entry["location"].startswith("paper/")]
    with open(path, "w", encoding="utf-8") as file:
        json.dump(index, file, sort_keys=True, separators=(",", ":"))
