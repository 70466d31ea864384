// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/progress.h"
#include "output/output_path.h"

namespace landfall {

/// What of a landfall file is exported, and how. What is empty has a default.
struct ExportOptions {
  std::string input;
  std::string format;                ///< "csv", "las", "ply", "png", "tif" or "xmf"
  std::vector<std::string> layers;   ///< of a grid; of a scan, for a picture, a column or "count"
  std::vector<std::string> columns;  ///< of a scan's points
  std::string position;              ///< of a scan's points: "est" or "true"
  std::size_t every = 1;             ///< points, or lines of a .csv: the first and every N-th after it
  bool keep_misses = false;          ///< of a scan, as .csv
};

/// The export of one file: by default in the format of the output's extension, to standard output ("-") as
/// .csv.
class FileExport {
 public:
  /// Throws UsageError where input, format, output and options do not go together, naming the option as
  /// landfall-export has it, and FormatError where the input is no landfall file.
  FileExport(ExportOptions options, const std::string& output);

  /// A second output, beside the first: the points' positions of an .xmf. Empty: none.
  [[nodiscard]] std::string second_output() const;

  /// Writes `output`, whose path is that of the constructor; `tool` is what the file says it comes from.
  /// Throws ClosedPipe (byte_sink.h), and as the formats' writers do.
  void write(const OutputOptions& output, const std::string& tool, const ProgressCallback& progress) const;

 private:
  ExportOptions options_;
  std::string output_;
  std::string kind_;
};

}  // namespace landfall
