// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "store/files/provenance.h"

namespace landfall {

/// Thrown in place of writing an output that already is what the run would write.
struct OutputIsCurrent {};

/// While an object lives, an existing output is left if it is a complete file with the file_id that the new
/// one would have: LandfallFileWriter throws OutputIsCurrent instead of replacing or refusing it. For writers
/// of the same thread.
class CurrentOutputsAreKept {
 public:
  explicit CurrentOutputsAreKept(bool kept) : before_(are_kept()) { are_kept() = kept; }
  ~CurrentOutputsAreKept() { are_kept() = before_; }
  CurrentOutputsAreKept(const CurrentOutputsAreKept&) = delete;
  CurrentOutputsAreKept& operator=(const CurrentOutputsAreKept&) = delete;

  [[nodiscard]] static bool& are_kept() {
    thread_local bool kept = false;
    return kept;
  }

 private:
  bool before_;
};

/// Throws OutputIsCurrent if outputs are kept and `path` is such a file of this kind. All inputs must have
/// been added to `provenance`.
void leave_current(const std::filesystem::path& path, const std::string& kind, const Provenance& provenance);

}  // namespace landfall
