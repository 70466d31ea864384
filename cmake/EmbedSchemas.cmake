# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DOUTPUT=embedded_schemas.h -DSCHEMAS="a.schema.json;b.schema.json" -P EmbedSchemas.cmake
# Writes the schemas as raw string literals, so that a tool needs no file beside it.
set(text "// SPDX-License-Identifier: GPL-3.0-or-later\n// Made by CMake from schemas/.\n#pragma once\n\n")
string(APPEND text "namespace landfall {\nstruct EmbeddedSchema {\n  const char* name;\n  const char* text;\n};\n")
string(APPEND text "inline constexpr EmbeddedSchema kEmbeddedSchemas[] = {\n")
foreach(schema ${SCHEMAS})
  file(READ ${schema} content)
  get_filename_component(name ${schema} NAME_WE)
  string(APPEND text "    {\"${name}\", R\"schema(${content})schema\"},\n")
endforeach()
string(APPEND text "};\n}  // namespace landfall\n")
file(WRITE ${OUTPUT} "${text}")
