#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
# Stage by stage. The independent verification computes each file from the previous one, as written and already
# compared: no bin or status changes because of a difference in the last bits of an earlier stage, and every stage has
# its own tolerances.
#
# Component types are drawn without replacement, so that any seed covers all scanners, patterns, trajectories, errors,
# terrains and methods.
#
# Values for which rounding decides (bin borders, limits, edges of holes, total reflection) are excluded only if the second
# computation itself detects this, and they are counted.
"""Small random configurations through the whole chain; every number is compared with an independent numpy implementation.

LANDFALL_TEST_SEED sets the seed, LANDFALL_PROOF_CASES the number of configurations (50), and LANDFALL_PROOF_ONLY the number
of the only case to run. `chain_test.py --write` also writes the table of docs/quality/tests.md.
"""
import os
import sys
import unittest

from faults import page
from harness import ToolTest
from oracle import cases, comparison, landing
from oracle.ledger import Ledger

SEED = int(os.environ.get("LANDFALL_TEST_SEED", "20261121"))
COUNT = int(os.environ.get("LANDFALL_PROOF_CASES", "50"))
ONLY = os.environ.get("LANDFALL_PROOF_ONLY")
WRITE = "--write" in sys.argv


class Chain(ToolTest):
    def test_every_number_of_every_case(self):
        ledger, generator, landers = Ledger(), cases.CaseGenerator(SEED, self.folder), landing.Landers(SEED)
        with comparison.inside(self.folder):
            for number in range(COUNT):
                case = generator.case()
                lander = landers.config(case["regrid"]["resolution_m"])
                if ONLY is None or int(ONLY) == number:
                    ledger.case = f"{number} {case['dealt']} {case['options']}"
                    comparison.run_chain(case)
                    comparison.check(case, ledger)
                    ledger.case += f" {lander}"
                    landing.check(lander, ledger)
        print(f"seed {SEED}, {COUNT} configurations", *ledger.table(), *ledger.summary(), sep="\n")
        self.assertEqual(ledger.failures, [], "\n".join(ledger.failures))
        if WRITE:
            page.write(page.with_table(page.read(), page.ORACLE, ledger.summary()))


if __name__ == "__main__":
    sys.argv = [argument for argument in sys.argv if argument != "--write"]
    unittest.main()
