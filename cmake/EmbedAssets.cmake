# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DOUTPUT=embedded_assets.h -DASSETS="report.html;report.css" -P EmbedAssets.cmake
# Writes the files as raw string literals, so that a report needs no file beside the tool.
set(text "// SPDX-License-Identifier: GPL-3.0-or-later\n// Made by CMake from lib/report/assets/.\n#pragma once\n\n")
string(APPEND text "namespace landfall {\nstruct EmbeddedAsset {\n  const char* name;\n  const char* text;\n};\n")
string(APPEND text "inline constexpr EmbeddedAsset kEmbeddedAssets[] = {\n")
foreach(asset ${ASSETS})
  file(READ ${asset} content)
  get_filename_component(name ${asset} NAME)
  string(APPEND text "    {\"${name}\", R\"asset(${content})asset\"},\n")
endforeach()
string(APPEND text "};\n}  // namespace landfall\n")
file(WRITE ${OUTPUT} "${text}")
