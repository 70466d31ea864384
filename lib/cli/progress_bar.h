// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall::cli {

/// Seconds on a clock that never goes back.
[[nodiscard]] double wall_seconds();
/// CPU seconds of the whole process.
[[nodiscard]] double cpu_seconds();

/// One phase's bar on a terminal, redrawn at most ten times a second, with the time left. The last line
/// stays, with the time that the phase took.
class ProgressBar {
 public:
  explicit ProgressBar(std::string phase);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(double fraction);
  /// The phase succeeded: leaves its line. Without it the line is wiped.
  void finish();

 private:
  void draw(double fraction, const std::string& tail) const;

  std::string phase_;
  double start_s_;
  double drawn_s_ = -1;
};

}  // namespace landfall::cli
