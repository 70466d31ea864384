// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fstream>
#include <string>

namespace landfall::cli {

/// The file of --log: everything that a run says, also what -q and the lack of -v keep from the terminal.
class RunLog {
 public:
  /// Appends to a log, or begins one. Throws UsageError if the file is not a log of landfall: nothing else is
  /// ever changed; also if it cannot be written.
  void open(const std::string& path);
  /// Adds a line, with shown_text(); does nothing if no log is open.
  void write(const std::string& line);

 private:
  std::ofstream file_;
};

}  // namespace landfall::cli
