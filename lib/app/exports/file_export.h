// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/core/progress.h"
#include "base/output/output_path.h"

namespace landfall {

/// The names of the formats, which are their extensions without the dot.
[[nodiscard]] std::vector<std::string> export_formats();

/// Whether a file of this kind can be exported to a file with this extension (".tif"); of any kind if `kind`
/// is empty.
[[nodiscard]] bool is_exported(const std::string& kind, const std::string& extension);

/// The part of a landfall file to export, and the format. Empty members have defaults.
struct ExportOptions {
  std::string input;
  std::string format;                ///< one of export_formats()
  std::vector<std::string> layers;   ///< of a grid; of a scan, for an image, a column or "count"
  std::vector<std::string> columns;  ///< of a scan's points
  std::string position;              ///< of a scan's points: "est" or "true"
  std::size_t every = 1;             ///< points, or lines of a .csv: the first and every N-th after it
  bool keep_misses = false;          ///< of a scan, only as .csv
  std::string time;                  ///< of a scan, as .las: "scan" or "gps"
  std::string frame;           ///< of a scan's positions: "site" or "map"; default map where there is one
  std::size_t max_points = 0;  ///< of a scan, as .html; 0: the default
  bool sites = false;          ///< of a hazard map, as .csv or .gpkg: its landing sites, no layers
};

/// The export of one file: by default in the format of the output's extension, or as .csv to standard output
/// ("-").
class FileExport {
 public:
  /// Throws UsageError if input, format, output and options do not fit together, naming the option as in
  /// landfall-export, and FormatError if the input is not a landfall file.
  FileExport(ExportOptions options, const std::string& output);

  [[nodiscard]] const std::string& format() const { return options_.format; }
  /// The second output: the points' positions of an .xmf. Empty if there is none.
  [[nodiscard]] std::string second_output() const;

  /// Writes `output`, in any format but html (app/runs/cloud_output.h), whose path is that of the
  /// constructor; `tool` is the software name in the file. Returns a remark about its values that the user
  /// should see, or nothing. Throws ClosedPipe (byte_sink.h), and as the formats' writers do.
  [[nodiscard]] std::string write(const OutputOptions& output, const std::string& tool,
                                  const ProgressCallback& progress) const;

 private:
  ExportOptions options_;
  std::string output_;
  std::string kind_;
};

}  // namespace landfall
