#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The site that scripts/docs builds: every link and anchor holds, every page is near, its search finds, nothing leaves the machine."""
import collections
import functools
import html
import html.parser
import http.server
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest
import urllib.parse

import page as pages
from harness import browser, read_bytes
from harness.page import FAINT, IMAGES, LAYOUT, WIDTHS

ROOT = os.path.abspath(os.environ["LANDFALL_ROOT"])
sys.path.insert(0, os.path.join(ROOT, "scripts", "site"))
# pylint: disable=wrong-import-position
import stage

TEXTS = stage.texts()
MISSING = [program for program in ("mkdocs", "doxygen") if not shutil.which(program)] + ([] if os.path.exists(stage.KATEX) else ["libjs-katex"])
START = "index.html"
GENERATED = "docs/reference/api.md"  # holds text that mkdocstrings makes
GENERATED_PAGE = "docs/reference/api.html"
# Queries of new users, and the page that the search must name first.
FIRST = {"LAS": "docs/user/landfall-export", "safe": "docs/user/hazard-map", "which lidar": "docs/user/which-lidar", "how many pulses": "docs/user/scan-sim",
         "python notebook": "docs/user/python", "why does my map fail": "docs/user/symptoms", "sun angle": "docs/user/faq", "resume study": "docs/user/studies/index",
         "noise.range_sigma_m": "docs/reference/keys/scan-sim", "footprint": "docs/user/glossary", "roughness": "docs/user/hazard-map",
         "slope limit": "docs/user/hazard-map", "SBET": "docs/user/lidar/trajectory-table", "probability": "docs/user/monte-carlo", "GPU": "docs/user/gpu",
         "seed": "docs/user/glossary", "dropouts": "docs/user/studies/dropout", "glossary": "docs/user/glossary", "cite": "docs/user/faq",
         "p_safe": "docs/reference/hazard-methods", "dead pixel": "docs/user/studies/dead-pixels"}
SEEN = (START, "docs/index.html", "docs/user/glossary.html", "docs/user/python.html", "docs/user/errors.html", "docs/user/studies/index.html",
        "docs/reference/api.html", "docs/reference/keys/scan-sim.html")
# Elements and attributes whose files a browser loads by itself.
LOADED = {("script", "src"), ("img", "src"), ("link", "href"), ("iframe", "src"), ("source", "src")}


class Document(html.parser.HTMLParser):
    """A page of the site, or a part of it: the targets of its links, what it loads, its ids and the number of its elements."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loads, self.ids, self.counts, self.text = [], [], set(), collections.Counter(), text
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.counts[tag] += 1
        for name, value in attrs:
            if name == "id":
                self.ids.add(value)
            elif (tag, name) in LOADED:
                self.loads.append(value)
            elif (tag, name) == ("a", "href"):
                self.links.append(value)


def read(path):
    return read_bytes(path).decode()


def built_page(name):
    """The path in the site of a page of the repository."""
    return re.sub(r"README\.html$", "index.html", name.removesuffix(".md") + ".html")


def target_of(page, link):
    """The page and the anchor that a link of `page` leads to; None for one to another site."""
    link = urllib.parse.urlsplit(link)
    if link.scheme or link.netloc:
        return None
    path = os.path.normpath(os.path.join(os.path.dirname(page), urllib.parse.unquote(link.path))) if link.path else page
    return (os.path.join(path, "index.html").removeprefix("./") if link.path.endswith("/") or path == "." else path), urllib.parse.unquote(link.fragment)


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *arguments):  # pylint: disable=arguments-differ
        pass


class Built:
    """The site in a new folder, built once."""
    folder, documents = None, {}

    @classmethod
    def build(cls):
        cls.folder = tempfile.mkdtemp(prefix="landfall-site-")
        unittest.addModuleCleanup(shutil.rmtree, cls.folder)
        done = subprocess.run([os.path.join(ROOT, "scripts", "docs"), cls.folder], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise AssertionError(done.stdout + done.stderr)
        for folder, _, names in os.walk(cls.folder):
            for name in names:
                path = os.path.relpath(os.path.join(folder, name), cls.folder)
                if name.endswith(".html") and not path.startswith("cpp/") and path != "404.html":
                    cls.documents[path] = Document(read(os.path.join(folder, name)))


def setUpModule():  # pylint: disable=invalid-name
    if MISSING:
        raise unittest.SkipTest(f"needs {', '.join(MISSING)}: scripts/install-packages --docs")
    Built.build()


class Site(unittest.TestCase):
    maxDiff = None

    def test_every_page_is_there(self):
        self.assertLessEqual(set(map(built_page, TEXTS)), set(Built.documents))
        self.assertTrue(os.path.exists(os.path.join(Built.folder, "cpp", "index.html")))

    def test_every_link_and_anchor_holds(self):
        broken, checked = [], 0
        for page, document in Built.documents.items():
            for link in document.links + document.loads:
                target = target_of(page, link)
                if target is None:
                    continue
                checked += 1
                path, anchor = target
                if not os.path.isfile(os.path.join(Built.folder, path)) or anchor and path in Built.documents and anchor not in Built.documents[path].ids:
                    broken.append((page, link))
        self.assertGreater(checked, 1000)
        self.assertEqual(broken, [])

    def test_every_page_is_three_clicks_away(self):
        reached = near = {START}
        for _ in range(3):
            near = {target[0] for page in near for link in Built.documents[page].links if (target := target_of(page, link))} & set(Built.documents) - reached
            reached = reached | near
        self.assertEqual(sorted(set(Built.documents) - reached), [])

    def test_nothing_is_loaded_from_elsewhere(self):
        self.assertEqual([(page, load) for page, document in Built.documents.items() for load in document.loads if target_of(page, load) is None], [])
        for folder, _, names in os.walk(os.path.join(Built.folder, "assets")):
            for name in names:
                if name.endswith(".css"):
                    self.assertEqual(re.findall(r"url\(['\"]?(https?:[^)]*)", read(os.path.join(folder, name))), [], name)

    def test_markdown_is_read_as_on_github(self):
        """Each fence, table and list item of a page is one on the site."""
        for name, text in TEXTS.items():
            parsed = pages.Page(name, text)
            prose, shown = parsed.prose.values(), [block for block in parsed.blocks if block.language not in ("setup", "long setup")]
            counts = Document(re.search(r"<article.*?</article>", Built.documents[built_page(name)].text, re.DOTALL)[0]).counts
            if name != GENERATED:
                self.assertGreaterEqual(counts["pre"], len(shown), name)
                self.assertEqual(counts["table"], sum(bool(re.match(r" *\|(?=.*-)[-|: ]+\|$", line)) for line in prose), name)
                self.assertEqual(counts["li"], sum(bool(re.match(r" *([-*]|\d+\.) ", line)) for line in prose), name)

    def test_every_public_name_has_its_entry(self):
        import landfall  # pylint: disable=import-outside-toplevel
        ids = Built.documents[GENERATED_PAGE].ids  # a module has entries of its functions
        self.assertEqual([name for name in landfall.__all__ if not any((anchor + ".").startswith((f"landfall.{name}.", f"landfall.memory.{name}."))
                                                                        for anchor in ids)], [])
        names = re.findall(r"(?m)^(?:struct|class|enum class|using) (\w+)", read(os.path.join(ROOT, "lib", "app", "host", "lidar.h")))
        self.assertGreater(len(names), 8)
        shown = "".join(read(os.path.join(Built.folder, "cpp", name)) for name in os.listdir(os.path.join(Built.folder, "cpp")) if name.endswith(".html"))
        self.assertEqual([name for name in names if f">{name}</" not in shown and f"{name} " not in shown], [])

    def test_the_heading_names_the_version(self):
        version = re.search(r"project\(landfall VERSION (\S+)", read(os.path.join(ROOT, "CMakeLists.txt")))[1]
        self.assertRegex(Built.documents[START].text, rf"(?s)<header.*landfall {re.escape(version)}\s*<.*</header>")


@unittest.skipIf(browser.missing(), browser.missing())
class Search(unittest.TestCase):
    """The site as a browser shows it, from a plain web server."""

    @classmethod
    def setUpClass(cls):
        cls.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=Built.folder))
        cls.addClassCleanup(cls.server.server_close)
        cls.addClassCleanup(cls.server.shutdown)
        threading.Thread(target=cls.server.serve_forever, daemon=True).start()
        cls.address = f"http://127.0.0.1:{cls.server.server_port}/"
        cls.window = browser.Browser()
        cls.addClassCleanup(cls.window.close)

    def first_result(self, words):
        """The path of the page that the search names first."""
        self.window.driver.get(self.address)
        self.window.wait("return document.querySelector('.md-search__input') !== null")
        self.window.run("document.getElementById('__search').click()")
        field = self.window.driver.find_element("css selector", ".md-search__input")
        self.window.run("arguments[0].focus()", field)
        field.send_keys(words)
        self.window.wait("return document.querySelector('.md-search-result__link') !== null", 300)
        link = self.window.run("return document.querySelector('.md-search-result__link').href")
        return urllib.parse.urlsplit(link).path.lstrip("/")

    def test_the_search_finds_the_right_page_first(self):
        self.assertEqual({words: self.first_result(words) for words in FIRST}, {words: page + ".html" for words, page in FIRST.items()})

    def test_titles_of_results_are_those_of_pages(self):
        self.first_result("hazard-map")
        titles = self.window.run("return [...document.querySelectorAll('.md-search-result__item')].map((item) => item.innerText)")
        self.assertGreater(len(titles), 3)
        self.window.wait("return Number(getComputedStyle(document.querySelector('.md-search__output')).opacity) === 1", 20)
        self.assertEqual(self.window.run(FAINT), [])
        self.assertEqual(self.window.run("return [...document.querySelectorAll('.md-tag')].filter((tag) => tag.offsetHeight > 0).length"), 0)
        self.assertEqual([text for text in titles if "hazard.Keys" in text], [])
        self.assertEqual([entry for entry in json.loads(read(os.path.join(Built.folder, "search", "search_index.json")))["docs"] if entry["location"].startswith("paper/")], [])

    def check_page(self, page, scheme, width):
        where = f"{page}, {scheme}, {width} px"
        if width == WIDTHS[0]:  # colours are the same at all widths
            self.assertEqual(self.window.run(FAINT), [], where)
        self.assertEqual(self.window.run(LAYOUT), {"pairs": [], "scroll": 0, "wide": []}, where)
        self.assertGreater(self.window.run("return document.querySelector('article').innerText.length"), 200, where)
        self.assertNotIn(False, self.window.run(IMAGES), where)
        if "LANDFALL_SCREENS" in os.environ:
            self.window.picture(os.path.join(os.environ["LANDFALL_SCREENS"], f"site-{scheme}-{width}-{page.replace('/', '-')}.png"), {"x": 0, "y": 0, "width": width, "height": 1000})

    def test_pages_can_be_read_in_light_and_dark_at_all_widths(self):
        """Between them the pages have all colours of the theme: of code, tables, links, formulas, notes and navigation."""
        self.addCleanup(self.window.driver.execute_cdp_cmd, "Emulation.setEmulatedMedia", {"features": []})
        for scheme, name in (("light", "default"), ("dark", "slate")):
            self.window.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
            self.window.driver.get(self.address)
            self.window.run("localStorage.clear()")
            for page in SEEN:
                self.window.driver.get(self.address + page)
                self.assertEqual(self.window.run("return document.body.dataset.mdColorScheme"), name)
                for width in WIDTHS:
                    self.window.resize(width)
                    self.check_page(page, scheme, width)

    def test_long_pages_have_a_table_of_contents(self):
        self.window.resize(1400)
        for page, document in Built.documents.items():
            if document.counts["h2"] > 12:
                self.assertIn("md-nav--secondary", document.text, page)
        self.window.driver.get(self.address + "docs/reference/keys/scan-sim.html")
        shown = self.window.run("return [...document.querySelectorAll('.md-sidebar--secondary .md-nav__link')].filter((link) => link.offsetHeight > 0).length")
        self.assertTrue(5 < shown < 60, f"{shown} entries of {Built.documents['docs/reference/keys/scan-sim.html'].counts['h3']} keys")

    def test_no_request_leaves_the_machine(self):
        self.window.requests()
        for page in (START, "docs/user/glossary.html", "docs/reference/api.html", "docs/reference/keys/scan-sim.html"):
            self.window.driver.get(self.address + page)
        self.first_result("footprint")
        asked = self.window.requests()
        self.assertGreater(len(asked), 20)
        self.assertEqual([url for url in asked if not url.startswith(self.address)], [])

    def test_formulas_are_typeset(self):
        self.window.driver.get(self.address + "docs/user/glossary.html")
        counts = self.window.run("return [document.querySelectorAll('.arithmatex').length, document.querySelectorAll('.arithmatex .katex').length]")
        self.assertGreater(counts[0], 3)
        self.assertEqual(counts[0], counts[1])
        self.assertEqual([entry for entry in self.window.driver.get_log("browser") if entry["level"] == "SEVERE"], [])

    def test_every_formula_can_be_typeset(self):
        formulas = [html.unescape(formula) for document in Built.documents.values()
                    for formula in re.findall(r'class="arithmatex">\s*\\[(\[](.*?)\\[)\]]\s*<', document.text, re.DOTALL)]
        self.assertGreater(len(formulas), 60)
        self.window.driver.get(self.address + "docs/user/glossary.html")
        wrong = self.window.run("""return arguments[0].filter(formula => {
            try { katex.renderToString(formula, {displayMode: true, throwOnError: true}); return false; } catch (error) { return true; } })""", formulas)
        self.assertEqual(wrong, [])

    def test_dark_and_light(self):
        self.window.driver.get(self.address)
        before = self.window.run("return getComputedStyle(document.body).backgroundColor")
        self.window.run("[...document.querySelectorAll('[data-md-component=palette] label')].find(label => !label.hidden).click()")
        self.window.wait(f"return getComputedStyle(document.body).backgroundColor !== {json.dumps(before)}", 20)


if __name__ == "__main__":
    unittest.main()
