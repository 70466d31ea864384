# SPDX-License-Identifier: GPL-3.0-or-later
# The files that are installed beside programs, plugin and module. share/landfall mirrors the repository, so that python/ and
# Makefile.studies find each other, the schemas and the studies by the same relative paths; so does share/doc/landfall for the
# links between the pages.
set(share ${CMAKE_INSTALL_DATADIR}/landfall)
install(DIRECTORY studies DESTINATION ${share} USE_SOURCE_PERMISSIONS PATTERN __pycache__ EXCLUDE)
install(DIRECTORY schemas DESTINATION ${share} REGEX "(chain|draws|study|sensitivity|design).schema.json" EXCLUDE)
install(DIRECTORY ${CMAKE_BINARY_DIR}/schemas DESTINATION ${share})
install(FILES Makefile.studies DESTINATION ${share})
install(DIRECTORY python DESTINATION ${share} USE_SOURCE_PERMISSIONS PATTERN __pycache__ EXCLUDE PATTERN ".*" EXCLUDE)
install(DIRECTORY lib/app/report/web DESTINATION ${share}/lib/app/report)
# `import landfall` in Debian's python3: a link, so that there is one copy.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/dist-packages)
file(CREATE_LINK ../../../share/landfall/python/landfall ${CMAKE_BINARY_DIR}/dist-packages/landfall SYMBOLIC)
install(FILES ${CMAKE_BINARY_DIR}/dist-packages/landfall DESTINATION lib/python3/dist-packages)
# The pages with those that scripts/site makes: every key, every message.
file(GLOB_RECURSE pages CONFIGURE_DEPENDS docs/* schemas/*.json scripts/site/*.py python/landfall/*.py)
add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/pages.stamp
                   COMMAND /usr/bin/python3 -B scripts/site/stage.py --docs ${CMAKE_BINARY_DIR}/pages
                   COMMAND ${CMAKE_COMMAND} -E touch ${CMAKE_BINARY_DIR}/pages.stamp
                   DEPENDS ${pages} tests/cli/catalogue.json README.md CONTRIBUTING.md CHANGELOG.md
                   WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
add_custom_target(landfall_pages ALL DEPENDS ${CMAKE_BINARY_DIR}/pages.stamp)
install(DIRECTORY ${CMAKE_BINARY_DIR}/pages/docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES packaging/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
