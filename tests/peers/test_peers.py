#!/usr/bin/env python3
"""usage: test_peers.py VITRUM SCRATCH. tools/peers with vitrum alone, its score, what its document says of figures."""

import json
import math
import pathlib
import shutil
import subprocess
import sys
import unittest
import xml.dom.minidom

ROOT = pathlib.Path(__file__).resolve().parents[2]
VITRUM, SCRATCH = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "tools"))

from peer_systems.curves import Curve, Point
from peer_systems.document import write_document
from peer_systems.process import Failed
from peer_systems.systems import PIXELS, scored


def run(*options):
    command = [sys.executable, "-B", ROOT / "tools/peers", "--vitrum", VITRUM, "--output", SCRATCH, *options]
    return subprocess.run(command, capture_output=True, text=True)


class WithVitrumAlone(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(SCRATCH, ignore_errors=True)
        SCRATCH.mkdir(parents=True)
        cls.done = run("--only", "vitrum", "--quick")

    def test_it_writes_figures_document_and_figure(self):
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        lines = json.loads((SCRATCH / "performance/runs.json").read_text())["vitrum"]["cases"]["ball"]
        self.assertEqual(sorted(lines), ["automatic radius", "footprints"])
        for points in lines.values():
            little, few, more = points
            self.assertLess(more["error"], few["error"])
            self.assertLess(few["passes"][0], few["whole"][0])
            self.assertAlmostEqual(more["flux"], 1, delta=0.02)
        self.assertLess(lines["footprints"][-1]["error"], 0.2)
        self.assertIn("vitrum, footprints", (SCRATCH / "performance.md").read_text())
        xml.dom.minidom.parse(str(SCRATCH / "performance/caustic_plate.svg"))

    def test_unknown_systems_are_refused(self):
        self.assertEqual(run("--only", "nobody").returncode, 2)


class Figures(unittest.TestCase):
    def test_score_is_relative_to_the_mean_within_the_circle(self):
        truth = [2.0] * PIXELS
        self.assertEqual(scored(truth, truth), (0.0, 1.0))
        error, flux = scored([3.0] * PIXELS, truth)
        self.assertAlmostEqual(error, 0.5)
        self.assertAlmostEqual(flux, 1.5)
        corner = [9.0] + truth[1:]
        self.assertEqual(scored(corner, truth), (0.0, 1.0))

    def test_levels_and_slopes_are_those_of_a_power_law(self):
        curve = Curve("vitrum", "v", [Point(n, n ** -0.5, 1, 1 + n, 2.0 * n) for n in (16, 64, 256, 1024)])
        self.assertAlmostEqual(curve.at("photons", 0.1), 100)
        self.assertAlmostEqual(curve.at("compute", 0.1), 200)
        self.assertIsNone(curve.at("photons", 0.01))
        self.assertAlmostEqual(curve.slope("compute"), -0.5)
        self.assertAlmostEqual(curve.exponent(0.2, 0.01), -0.5)
        self.assertAlmostEqual(curve.beyond(0.01), 20000)

    def test_the_document_tells_ratios_and_what_is_left_out(self):
        def system(name, cost, own):
            def point(amount):
                return {"amount": amount, "photons": amount, "error": math.sqrt(1 / amount), "flux": 1.0,
                        "whole": [1 + cost * amount], **({"passes": [cost * amount]} if own else {})}
            return {"name": name, "version": "1", "processor": "p", "settings": "s", "date": "d",
                    "cases": {"ball": {"line": [{**point(1), "whole": [1.0], **({"passes": [0.0]} if own else {})},
                                                *(point(n) for n in (16, 64, 256))]}}}
        systems = {"vitrum": system("vitrum", 1e-4, True), "mitsuba": system("Mitsuba", 0.2, False),
                   "luxcore": {"name": "LuxCore", "left_out": "no network"}}
        write_document(SCRATCH / "made", systems)
        page = (SCRATCH / "made/performance.md").read_text()
        self.assertIn("| LuxCore | left out |  |  | no network |", page)
        self.assertIn("2,000 times: 0.01 CPU s (line, 100 photons) against 20 |", page)
        self.assertIn("not measured here", page)
        systems["vitrum"]["benchmarks"] = {
            "scaling": {"commit": "c", "findings": [], "rows": [
                {"what": "passes", "photons": 1e6, "ns a photon": 50, "process MB": 100},
                {"what": "passes", "photons": 1e7, "ns a photon": 60, "process MB": 101},
                {"what": "threads", "photons": 4e6, "threads": 2, "photon CPU s": 0.1, "times that of one": 1.04}]},
            "traversal": {"commit": "c", "findings": ["slower"], "rows": [
                {"what": "primary", "triangles": 5e5, "times as fast": 1.4, "B/triangle": 90, "Embree's B": 80},
                {"what": "diffuse", "triangles": 5e5, "times as fast": 1.2, "B/triangle": 90, "Embree's B": 80}]},
            "startup": {"commit": "c", "findings": [], "rows": [{"what": "warm", "first pixel s": 0.1}]}}
        write_document(SCRATCH / "made", systems)
        page = (SCRATCH / "made/performance.md").read_text()
        self.assertIn("80 M/s by CPU time | yes |", page)
        self.assertIn("1.04 times, 2 threads | yes |", page)
        self.assertIn("50 / 60 ns", page)
        self.assertRegex(page, r"What a photon costs .* no \|")
        self.assertRegex(page, r"Primary, diffuse.* 1.2 to 1.4 \| no \|")
        self.assertRegex(page, r"Memory of a triangle.* 90 bytes, Embree 80 \| no \|")
        self.assertRegex(page, r"first pixel, warm: .15 s \| 0.1 s \| yes \|")
        self.assertIn("- *traversal*: ", page)
        self.assertNotIn("- *photons*: ", page)
        self.assertIn("- slower", page)
        systems["mitsuba"]["processor"] = "another"
        with self.assertRaises(Failed):
            write_document(SCRATCH / "made", systems)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
