# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall's files, figures and studies."""
