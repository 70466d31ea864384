# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers from many runs: the pipeline as a function, sensitivity, design."""
