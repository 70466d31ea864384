// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>

namespace landfall::cli {

/// Seconds on a monotonic clock.
[[nodiscard]] double wall_seconds();
/// CPU time of the whole process, seconds.
[[nodiscard]] double cpu_seconds();

/// The progress bar of one phase on a terminal, redrawn at most ten times a second, with the remaining time.
/// The last line remains, with the time that the phase took.
class ProgressBar {
 public:
  explicit ProgressBar(std::string phase);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(double fraction);
  /// Shows a text behind the remaining time from the next update on.
  void note(std::string text) { note_ = std::move(text); }
  /// Call when the phase succeeded: its line remains. Otherwise the line is erased.
  void finish();

 private:
  void draw(double fraction, const std::string& tail) const;

  std::string phase_;
  double start_s_;
  double drawn_s_ = -1;
  std::string note_;
};

}  // namespace landfall::cli
