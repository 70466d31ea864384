#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
from start import start

start("answers.design")
