// SPDX-License-Identifier: GPL-3.0-or-later
#include "exports/point_properties.h"

#include "base/number_text.h"
#include "returns/columns.h"

namespace landfall {
namespace {

std::string property_name(const std::string& column) {
  return "scalar_" + (column == name_of(&PointColumns::range_measured) ? "range_meas" : column);
}

h5::Type written_type(h5::Type type) {
  return type == h5::Type::int8 || type == h5::Type::int32 || type == h5::Type::float32 ? type
                                                                                        : h5::Type::float64;
}

void append_value(std::string& out, const PointBatch& batch, std::size_t c, std::size_t row, h5::Type type) {
  switch (type) {
    case h5::Type::int8:
      return append_raw(out, std::get<std::vector<std::int8_t>>(batch.columns[c])[row]);
    case h5::Type::int32:
      return append_raw(out, std::get<std::vector<std::int32_t>>(batch.columns[c])[row]);
    case h5::Type::float32:
      return append_raw(out, static_cast<float>(batch.real(c)[row]));
    default:
      return append_raw(out, batch.number(c, row));
  }
}

}  // namespace

std::vector<PointProperty> point_properties(const PointReader& points, const PointReader::Pass& pass,
                                            h5::Type position) {
  std::vector<PointProperty> properties;
  for (const std::string& name : pass.columns) {
    const ContentInfo& column = points.column(name);
    if (properties.size() < 3)
      properties.push_back({column, std::string(1, "xyz"[properties.size()]), position});
    else
      properties.push_back({column, property_name(name), written_type(column.type)});
  }
  return properties;
}

EncodeRows encoder_of(const std::vector<PointProperty>& properties) {
  return [&properties](const PointBatch& batch, std::span<const std::uint32_t> rows, std::string& out) {
    for (const std::uint32_t row : rows)
      for (std::size_t c = 0; c < properties.size(); ++c)
        append_value(out, batch, c, row, properties[c].type);
  };
}

}  // namespace landfall
