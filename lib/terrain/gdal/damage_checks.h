// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cpl_conv.h>

#include <array>

namespace landfall {

/// While one lives, GDAL's drivers check on this thread what they skip by default: the checksums of DTED, and
/// damaged or truncated JPEG data. A value that the user has set (environment, configuration file) stays.
class DamageChecks {
 public:
  DamageChecks() {
    for (std::size_t i = 0; i < kOptions.size(); ++i) {
      is_set_[i] = CPLGetConfigOption(kOptions[i], nullptr) == nullptr;
      if (is_set_[i]) CPLSetThreadLocalConfigOption(kOptions[i], "YES");
    }
  }
  ~DamageChecks() {
    for (std::size_t i = 0; i < kOptions.size(); ++i)
      if (is_set_[i]) CPLSetThreadLocalConfigOption(kOptions[i], nullptr);
  }
  DamageChecks(const DamageChecks&) = delete;
  DamageChecks& operator=(const DamageChecks&) = delete;

 private:
  static constexpr std::array<const char*, 2> kOptions = {"DTED_VERIFY_CHECKSUM",
                                                          "GDAL_ERROR_ON_LIBJPEG_WARNING"};
  std::array<bool, kOptions.size()> is_set_{};
};

}  // namespace landfall
