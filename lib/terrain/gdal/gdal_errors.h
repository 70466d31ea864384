// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cpl_error.h>

#include <algorithm>
#include <cstring>
#include <string>

namespace landfall {

/// While it exists, captures GDAL's first error of this thread instead of printing it, and the first warning
/// that GDAL continues without data that it could not read.
class GdalErrors {
 public:
  GdalErrors() { CPLPushErrorHandlerEx(&GdalErrors::keep, this); }
  ~GdalErrors() { CPLPopErrorHandler(); }
  GdalErrors(const GdalErrors&) = delete;
  GdalErrors& operator=(const GdalErrors&) = delete;

  [[nodiscard]] bool any() const { return !first_.empty(); }
  [[nodiscard]] std::string reason() const { return any() ? first_ : "GDAL gives no reason"; }
  void clear() { first_.clear(); }
  /// The warning that a tag could not be read; empty without one. clear() keeps it.
  [[nodiscard]] const std::string& loss() const { return loss_; }

 private:
  static void CPL_STDCALL keep(CPLErr level, CPLErrorNum /*number*/, const char* message) {
    auto& self = *static_cast<GdalErrors*>(CPLGetErrorHandlerUserData());
    if (level >= CE_Failure && !self.any()) self.first_ = line(message);
    const bool is_loss = level == CE_Warning && std::strstr(message, "IO error during reading") != nullptr;
    if (is_loss && self.loss_.empty()) self.loss_ = line(message);
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
};

}  // namespace landfall
