// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/current_output.h"

#include "base/core/error.h"
#include "store/files/landfall_file.h"

namespace landfall {

void leave_current(const std::filesystem::path& path, const std::string& kind, const Provenance& provenance) {
  if (!CurrentOutputsAreKept::are_kept() || !std::filesystem::exists(path)) return;
  try {
    if (LandfallFileReader(path, {kind.c_str()}).file_id() != provenance.file_id()) return;
  } catch (const FormatError&) {  // another or a damaged file, which is refused or replaced
    return;
  }
  throw OutputIsCurrent();
}

}  // namespace landfall
