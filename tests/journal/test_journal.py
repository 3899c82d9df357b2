#!/usr/bin/env python3
"""usage: test_journal.py VITRUM SCRATCH. The journal at 32 x 32: a valid page with all sections, and its refusals."""

import base64
import html.parser
import importlib.machinery
import importlib.util
import pathlib
import shutil
import struct
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
VITRUM, SCRATCH = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
SECTIONS = ["transparent-tenth", "transparent-fresnel", "difference", "glossy", "photon-maps", "volume",
            "glossy-volume"]
PICTURES = [1, 1, 1, 2, 2, 1, 2]
CODE = ["fresnel", "refract", "bouguer", "split", "photon", "aimed", "direct", "gather", "volume"]
VOID = {"img", "meta"}


def load_journal():
    sys.path.insert(0, str(ROOT / "tools"))
    loader = importlib.machinery.SourceFileLoader("journal", str(ROOT / "tools/journal"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("journal", loader))
    loader.exec_module(module)
    return module


class Page(html.parser.HTMLParser):
    """What the page holds; raises AssertionError where its tags do not match."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.links, self.images, self.code, self.commands = [], [], [], [], {}, []
        self.in_section, self.rows = {}, 0
        self.feed(text)
        self.close()
        assert not self.open, f"not closed: {self.open}"

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        if tag == "a":
            self.links.append(attributes["href"])
        if tag == "img":
            self.images.append(attributes)
            self.in_section[self.ids[-1]] = self.in_section.get(self.ids[-1], 0) + 1
        if tag == "tr":
            self.rows += 1
        if attributes.get("class") == "command":
            self.commands.append("")
        if attributes.get("class") == "code":
            self.code[attributes["data-name"]] = ""
        if tag not in VOID:
            self.open.append((tag, attributes))

    def handle_endtag(self, tag):
        assert self.open and self.open[-1][0] == tag, f"</{tag}> closes {self.open[-1:]}"
        self.open.pop()

    def handle_data(self, data):
        for tag, attributes in self.open:
            if attributes.get("class") == "command":
                self.commands[-1] += data
            if attributes.get("class") == "code":
                self.code[attributes["data-name"]] += data


class Journal(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(SCRATCH, ignore_errors=True)
        SCRATCH.mkdir(parents=True)
        cls.file = SCRATCH / "page.html"
        done = subprocess.run([sys.executable, "-B", ROOT / "tools/journal", "--vitrum", VITRUM, "-o", cls.file,
                                  "--size", "32", "--samples", "1", "--photons", "2000", "--dots", "500"],
                                 capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        cls.text = cls.file.read_text()
        cls.page = Page(cls.text)
        cls.journal = load_journal()

    def test_has_all_sections(self):
        self.assertEqual(self.page.ids, SECTIONS)
        self.assertEqual(self.page.links, ["#" + name for name in SECTIONS])
        self.assertEqual([self.page.in_section.get(name, 0) for name in SECTIONS], PICTURES)

    def test_is_self_contained(self):
        self.assertNotIn("http", self.text)
        self.assertNotIn("<script", self.text)
        for image in self.page.images:
            data = base64.b64decode(image["src"].removeprefix("data:image/png;base64,"), validate=True)
            self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
            self.assertEqual(struct.unpack(">II", data[16:24]), (32, 32))

    def test_gives_command_and_figures_of_each_picture(self):
        self.assertEqual(len(self.page.commands), sum(PICTURES))
        for command in self.page.commands:
            if "render" in command:
                self.assertIn("models/default_scene/scene.toml", command)
                self.assertIn("--set material.glass.illum=", command)
        self.assertGreater(self.page.rows, 6 * sum(PICTURES) - 4)
        self.assertIn("photons shot, stored", self.text)
        self.assertIn("balance", self.text)

    def test_code_is_that_of_the_sources(self):
        self.assertEqual(sorted(self.page.code), sorted(CODE))
        sources = ["\n".join(line.strip() for line in path.read_text().splitlines())
                   for path in (ROOT / "kernels").rglob("*") if path.is_file()]
        for name, code in self.page.code.items():
            stripped = "\n".join(line.strip() for line in code.splitlines())
            self.assertEqual(sum(f"// [{name}]\n{stripped}\n// [/{name}]" in text for text in sources), 1, name)

    def test_missing_or_doubled_marker_is_an_error(self):
        kernels = SCRATCH / "kernels"
        shutil.copytree(ROOT / "kernels", kernels)
        source = kernels / "fresnel.cl"
        whole = source.read_text()
        for broken in (whole.replace("// [fresnel]", ""), whole.replace("// [/fresnel]", ""),
                       whole.replace("// [fresnel]", "").replace("// [/fresnel]", ""),
                       whole + "\n// [fresnel]\nx\n// [/fresnel]\n"):
            source.write_text(broken)
            with self.assertRaisesRegex(self.journal.Failure, "fresnel"):
                self.journal.excerpt(kernels, "fresnel")
        source.write_text(whole)
        self.journal.excerpt(kernels, "fresnel")

    def test_failure_of_the_renderer_is_told_and_leaves_no_page(self):
        page = SCRATCH / "none.html"
        done = subprocess.run([sys.executable, "-B", ROOT / "tools/journal", "--vitrum", "/bin/false", "-o", page],
                              capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("failed", done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        self.assertFalse(page.exists())

    def test_exr_gives_the_values_that_the_png_shows(self):
        width, height, planes = self.journal.read_exr((SCRATCH / "page/transparent_fresnel.exr").read_bytes())
        self.assertEqual((width, height, sorted(planes)), (32, 32, ["B", "G", "R"]))
        for channel, background in zip("RGB", (0.1, 0.3, 0.6)):  # the sky, in the top row
            self.assertAlmostEqual(planes[channel][0], background, places=6)
            self.assertLess(planes[channel][-1], 0.9 * background if channel == "B" else 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
