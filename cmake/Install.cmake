# SPDX-License-Identifier: GPL-3.0-or-later
# What is installed beside programs, plugin and module. share/landfall mirrors the repository, so that scripts and
# Makefile.studies find each other, the schemas and the studies by the same relative paths; so does share/doc/landfall for the
# links between the pages.
set(share ${CMAKE_INSTALL_DATADIR}/landfall)
install(DIRECTORY schemas studies DESTINATION ${share})
install(FILES Makefile.studies DESTINATION ${share})
install(DIRECTORY scripts DESTINATION ${share} USE_SOURCE_PERMISSIONS
        PATTERN __pycache__ EXCLUDE
        # What works on a clone only.
        PATTERN fuzz EXCLUDE PATTERN coverage EXCLUDE PATTERN quickstart EXCLUDE PATTERN test EXCLUDE PATTERN test-deb EXCLUDE PATTERN package EXCLUDE
        PATTERN install-packages EXCLUDE PATTERN check_includes.py EXCLUDE)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES packaging/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
