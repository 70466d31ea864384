// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cpl_error.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

namespace landfall {

/// While it exists, captures GDAL's first error of this thread instead of printing it, the first warning that
/// GDAL continues without data that it could not read, its last warning, and whether it looked for a CRS in
/// vain.
class GdalErrors {
 public:
  GdalErrors() { CPLPushErrorHandlerEx(&GdalErrors::keep, this); }
  ~GdalErrors() { CPLPopErrorHandler(); }
  GdalErrors(const GdalErrors&) = delete;
  GdalErrors& operator=(const GdalErrors&) = delete;

  [[nodiscard]] bool any() const { return !first_.empty(); }
  [[nodiscard]] std::string reason() const { return any() ? first_ : "GDAL gives no reason"; }
  void clear() { first_.clear(); }
  /// The warning that data could not be read as stored; empty without one. clear() keeps it.
  [[nodiscard]] const std::string& loss() const { return loss_; }
  [[nodiscard]] const std::string& last_warning() const { return last_warning_; }
  /// PROJ's database lacks the code of a CRS. clear() keeps it.
  [[nodiscard]] bool unknown_crs() const { return unknown_crs_; }

 private:
  static void CPL_STDCALL keep(CPLErr level, CPLErrorNum /*number*/, const char* message) {
    auto& self = *static_cast<GdalErrors*>(CPLGetErrorHandlerUserData());
    if (level >= CE_Failure && !self.any()) self.first_ = line(message);
    if (std::strstr(message, "proj_create_from_database") != nullptr) self.unknown_crs_ = true;
    if (level == CE_Warning) self.last_warning_ = line(message);
    if (level == CE_Warning && self.loss_.empty() && is_loss(message)) self.loss_ = line(message);
  }
  /// libtiff continues after a tag that it could not read, guesses the sizes of strips that a file does not
  /// state, and fills up JPEG data that end early.
  static bool is_loss(const char* message) {
    constexpr std::array kLosses = {"IO error during reading", "\"StripByteCounts\"", "\"TileByteCounts\"",
                                    "Premature end of JPEG", "Corrupt JPEG data"};
    return std::ranges::any_of(kLosses,
                               [&](const char* part) { return std::strstr(message, part) != nullptr; });
  }
  static std::string line(std::string text) {
    if (const std::size_t end = text.find(':'); text.starts_with('_') && end != std::string::npos)
      text.erase(0, end + 1);  // the name of a GDAL function
    std::replace(text.begin(), text.end(), '\n', ' ');
    text.erase(text.find_last_not_of(" .") + 1);
    return text;
  }
  std::string first_;
  std::string loss_;
  std::string last_warning_;
  bool unknown_crs_ = false;
};

}  // namespace landfall
