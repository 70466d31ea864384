# SPDX-License-Identifier: GPL-3.0-or-later
# The files that are installed beside programs, plugin and module. share/landfall mirrors the repository, so that python/ and
# Makefile.studies find each other, the schemas and the studies by the same relative paths; so does share/doc/landfall for the
# links between the pages.
set(share ${CMAKE_INSTALL_DATADIR}/landfall)
install(DIRECTORY schemas studies DESTINATION ${share} USE_SOURCE_PERMISSIONS PATTERN __pycache__ EXCLUDE)
install(FILES Makefile.studies DESTINATION ${share})
install(DIRECTORY python DESTINATION ${share} USE_SOURCE_PERMISSIONS PATTERN __pycache__ EXCLUDE)
install(DIRECTORY lib/report/web DESTINATION ${share}/lib/report)
# `import landfall` in Debian's python3: a link, so that there is one copy.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/dist-packages)
file(CREATE_LINK ../../../share/landfall/python/landfall ${CMAKE_BINARY_DIR}/dist-packages/landfall SYMBOLIC)
install(FILES ${CMAKE_BINARY_DIR}/dist-packages/landfall DESTINATION lib/python3/dist-packages)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES packaging/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
