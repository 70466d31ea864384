# SPDX-License-Identifier: GPL-3.0-or-later
# Configurations in a report are stored as the first one of each stage and the differences of the others: 5,000 of them
# take 0.4 MB. Numbers have 7 digits.
"""Configurations of many cases: the first one, what each other one changes, and what all of them share."""
import copy
import re

from landfall.study.model import with_paths

VARIES = "(varies)"


def without_folders(value):
    """The value with every "path" cut to the file's name, as in the configuration that landfall's files store."""
    return with_paths(value, lambda path: re.sub(r'[^":]*/', "", path))


def changes(base, tree, place=()):
    """[[place, value], ...] that make `tree` of `base`, a place being a list of keys and indices; [place] removes a key."""
    if isinstance(base, dict) and isinstance(tree, dict):
        found = [[[*place, key]] for key in base if key not in tree]
        for key, value in tree.items():
            found += changes(base[key], value, (*place, key)) if key in base else [[[*place, key], value]]
        return found
    if isinstance(base, list) and isinstance(tree, list) and len(base) == len(tree):
        return [change for index, (before, after) in enumerate(zip(base, tree))
                for change in changes(before, after, (*place, index))]
    return [] if base == tree and type(base) is type(tree) else [[list(place), tree]]


def shared(base, all_steps):
    """The base with VARIES wherever any of the others differs from it."""
    tree = {"": copy.deepcopy(base)}
    for place in {tuple(place): None for steps in all_steps for place, *_ in steps}:
        _mark(tree, ("", *place))
    return tree[""]


def _mark(tree, place):
    node = tree
    for key in place[:-1]:
        if node[key] == VARIES:
            return
        node = node[key]
    node[place[-1]] = VARIES
