# SPDX-License-Identifier: GPL-3.0-or-later
"""One process at a time works in a study's folder: the lock is studies/runners/locked, which Makefile.studies calls."""
import os
import sys

LOCKED = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "..", "studies", "runners", "locked")


def need(folder):
    """Returns if make holds the lock of the folder for this process; else starts the command again, under the lock."""
    if os.environ.get("STUDY_LOCK") != folder:
        sys.stdout.flush()
        os.execv(LOCKED, [LOCKED, folder, sys.executable, *sys.argv])
