#!/usr/bin/env python3
"""usage: test_count_instructions.py VITRUM. tools/count_instructions on a kernel whose arithmetic is known."""

import pathlib
import platform
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
VITRUM = sys.argv[1]


def run(*words):
    return subprocess.run([sys.executable, "-B", ROOT / "tools/count_instructions", *words], capture_output=True, text=True)


@unittest.skipUnless(platform.machine() == "x86_64", "counts x86-64's instructions only")
class KnownKernel(unittest.TestCase):
    def test_it_counts_the_arithmetic_of_twelve_chains(self):
        # bench limits --quick: 64 work-items do 1,000 steps of 12 chains; a round that is not counted, and one that is.
        steps = 2 * 64 * 1000
        done = run("multiply_and_add", str(steps), VITRUM, "bench", "limits", "--quick", "--threads", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        name, instructions, vector, operations, touched = done.stdout.splitlines()[-1].split()
        self.assertEqual(name, "multiply_and_add")
        lanes = round(float(operations) / 24)
        self.assertIn(lanes, (4, 8, 16))
        self.assertAlmostEqual(float(operations), 24 * lanes, delta=0.1 * lanes)
        self.assertGreaterEqual(float(vector), 12)
        self.assertLess(float(instructions), 40)
        self.assertLess(float(touched), 24 * 4 * lanes)

    def test_kernels_that_do_not_run_are_told(self):
        done = run("nobody", "1", VITRUM, "devices")
        self.assertEqual(done.returncode, 1)
        self.assertIn("the command ran none of nobody", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
