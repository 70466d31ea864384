// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D442
#include "formats/points/cloud_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/text/number_text.h"
#include "base/text/shown_text.h"

namespace landfall {
namespace {

class ConvertedReader final : public CloudReader {
 public:
  ConvertedReader(std::unique_ptr<CloudReader> cloud, const std::array<double, kCloudFieldCount>& factors)
      : cloud_(std::move(cloud)), factors_(factors) {
    info_ = cloud_->info();
  }

  bool next(CloudBatch& batch) override {
    if (!cloud_->next(batch)) return false;
    for (std::size_t f = 0; f < kCloudFieldCount; ++f)
      if (factors_[f] != 1)
        for (double& value : batch.columns[f]) value *= factors_[f];
    return true;
  }
  void rewind() override { cloud_->rewind(); }
  [[nodiscard]] double progress() const override { return cloud_->progress(); }

 private:
  std::unique_ptr<CloudReader> cloud_;
  std::array<double, kCloudFieldCount> factors_;
};

/// "x in mm, z in ft" of the fields that are converted to a unit.
std::string converted_fields(const CloudInfo& info, const UnitConversion& conversion, ColumnUnit::Kind kind) {
  std::string list;
  for (std::size_t f = 0; f < kCloudFieldCount; ++f)
    if (info.units[f].kind == kind && conversion.factors[f] != 1)
      list += (list.empty() ? "" : ", ") + std::string(name_of(static_cast<CloudField>(f))) + " in " +
              shown_word(info.units[f].text);
  return list;
}

}  // namespace

UnitConversion unit_conversion(const CloudInfo& info, bool has_crs, std::optional<double> vertical_scale) {
  using enum ColumnUnit::Kind;
  UnitConversion conversion;
  for (std::size_t f = 0; f < kCloudFieldCount; ++f) {
    const bool is_map = f < 2 && info.units[f].kind == length && has_crs;
    conversion.factors[f] = is_map ? 1 : info.units[f].factor;
  }
  const ColumnUnit& z = info.units[static_cast<std::size_t>(CloudField::z)];
  if (vertical_scale) {
    conversion.factors[static_cast<std::size_t>(CloudField::z)] = 1;
    if (z.kind == length && std::abs(*vertical_scale - z.factor) > 1e-9 * std::abs(z.factor))
      conversion.notes.push_back("its header gives z in " + shown_word(z.text) + ", but --vertical-scale " +
                                 number_text(*vertical_scale) + " is taken");
  }
  const std::array<std::pair<ColumnUnit::Kind, const char*>, 3> results = {
      {{length, "metres, also for --center"}, {angle, "degrees, also for --center"}, {time, "seconds"}}};
  for (const auto& [kind, result] : results)
    if (const std::string fields = converted_fields(info, conversion, kind); !fields.empty())
      conversion.notes.push_back("its header gives " + fields + ": converted to " + result);
  return conversion;
}

std::unique_ptr<CloudReader> converted(std::unique_ptr<CloudReader> cloud, const UnitConversion& conversion) {
  if (std::ranges::all_of(conversion.factors, [](double factor) { return factor == 1; })) return cloud;
  return std::make_unique<ConvertedReader>(std::move(cloud), conversion.factors);
}

}  // namespace landfall
