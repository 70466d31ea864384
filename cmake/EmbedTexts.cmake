# SPDX-License-Identifier: GPL-3.0-or-later
# landfall_embed_texts(NAME assets FILES a.html b.css ...): files as raw string literals in a header that CMake makes, so
# that a tool needs no file beside it:
#   #include "app/embedded_assets.h"  // namespace landfall::embedded: kAssets[i].name, kAssets[i].text
# The file is also the script that writes it:
# cmake -DOUTPUT=... -DNAME=assets "-DTEXTS=a.html;b.css" -P EmbedTexts.cmake
if(CMAKE_SCRIPT_MODE_FILE)
  string(SUBSTRING ${NAME} 0 1 initial)
  string(TOUPPER ${initial} initial)
  string(SUBSTRING ${NAME} 1 -1 others)
  set(constant k${initial}${others})
  set(header "// SPDX-License-Identifier: GPL-3.0-or-later\n// Made by cmake/EmbedTexts.cmake.\n#pragma once\n\n")
  string(APPEND header "namespace landfall::embedded {\ninline constexpr struct {\n  const char* name;\n  const char* text;\n} ${constant}[] = {\n")
  foreach(path ${TEXTS})
    file(READ ${path} content)
    get_filename_component(name ${path} NAME)
    string(APPEND header "    {\"${name}\", R\"landfall(${content})landfall\"},\n")
  endforeach()
  string(APPEND header "};\n}  // namespace landfall::embedded\n")
  file(WRITE ${OUTPUT} "${header}")
  return()
endif()

function(landfall_embed_texts)
  cmake_parse_arguments(arg "" "NAME" "FILES" ${ARGN})
  set(script ${CMAKE_SOURCE_DIR}/cmake/EmbedTexts.cmake)
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${CMAKE_SOURCE_DIR}/lib OUTPUT_VARIABLE folder)
  set(header ${CMAKE_BINARY_DIR}/include/${folder}/embedded_${arg_NAME}.h)
  add_custom_command(OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${header} -DNAME=${arg_NAME} "-DTEXTS=${arg_FILES}" -P ${script}
    DEPENDS ${arg_FILES} ${script} VERBATIM)
  landfall_generates(embedded_${arg_NAME} ${header})
endfunction()
