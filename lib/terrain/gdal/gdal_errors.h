// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cpl_error.h>

#include <algorithm>
#include <string>

namespace landfall {

/// Keeps GDAL's first error of this thread instead of printing it, for as long as it lives.
class GdalErrors {
 public:
  GdalErrors() { CPLPushErrorHandlerEx(&GdalErrors::keep, this); }
  ~GdalErrors() { CPLPopErrorHandler(); }
  GdalErrors(const GdalErrors&) = delete;
  GdalErrors& operator=(const GdalErrors&) = delete;

  [[nodiscard]] bool any() const { return !first_.empty(); }
  [[nodiscard]] std::string reason() const { return any() ? first_ : "GDAL gives no reason"; }
  void clear() { first_.clear(); }

 private:
  static void CPL_STDCALL keep(CPLErr level, CPLErrorNum /*number*/, const char* message) {
    auto& self = *static_cast<GdalErrors*>(CPLGetErrorHandlerUserData());
    if (level < CE_Failure || self.any()) return;
    self.first_ = message;
    if (const std::size_t end = self.first_.find(':'); self.first_.front() == '_' && end != std::string::npos)
      self.first_.erase(0, end + 1);  // the name of a function of GDAL's
    std::replace(self.first_.begin(), self.first_.end(), '\n', ' ');
    self.first_.erase(self.first_.find_last_not_of(" .") + 1);
  }
  std::string first_;
};

}  // namespace landfall
