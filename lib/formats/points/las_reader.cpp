// SPDX-License-Identifier: GPL-3.0-or-later
// The points of LAS 1.0 to 1.4 (ASPRS). Colours, waveform packets and most extra bytes are skipped.
#include <limits>
#include <utility>

#include "formats/points/cloud_formats.h"
#include "formats/points/las_header.h"
#include "formats/points/row_reader.h"

namespace landfall {
namespace {

class LasReader final : public RowReader {
 public:
  LasReader(std::unique_ptr<CloudBytes> bytes, const LasHeader& las)
      : RowReader(std::move(bytes), las.rows), las_(las) {
    info_.format = "LAS 1." + std::to_string(las.minor) + ", point format " + std::to_string(las.format);
    for (const CloudField field :
         {CloudField::x, CloudField::y, CloudField::z, CloudField::intensity, CloudField::return_number,
          CloudField::number_of_returns, CloudField::classification})
      info_.columns[static_cast<std::size_t>(field)] = 0;
    if (las.time_offset > 0) {
      info_.columns[static_cast<std::size_t>(CloudField::t)] = 0;
      info_.clock = las.has_gps_time_of_1980 ? "adjusted standard GPS time: GPS seconds - 1e9"
                                             : "GPS seconds of the week, or since the first pulse";
    }
    if (las.width_offset > 0) info_.columns[static_cast<std::size_t>(CloudField::echo_width)] = 0;
    info_.point_count = static_cast<std::int64_t>(las.rows.count);
    info_.steps = las.steps;
    info_.box = las.box;
    info_.crs_wkt = las.crs_wkt;
    info_.geo_keys = las.geo_keys;
    info_.notes = las.notes;
  }

 protected:
  void decode(std::span<const std::byte> bytes, std::size_t begin, std::size_t end,
              CloudBatch& batch) const override {
    const unsigned bits = las_.is_extended() ? 4 : 3;  // of the number of a return
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<const std::byte> point = bytes.subspan(i * las_.rows.row_size, las_.rows.row_size);
      for (std::size_t axis = 0; axis < 3; ++axis)
        batch.columns[axis][i] =
            number_at<std::int32_t>(point, 4 * axis) * las_.steps.scale[axis] + las_.steps.offset[axis];
      batch[CloudField::intensity][i] = number_at<std::uint16_t>(point, 12);
      const unsigned returns = number_at<std::uint8_t>(point, 14);
      const unsigned mask = (1U << bits) - 1;
      batch[CloudField::return_number][i] = returns & mask;
      batch[CloudField::number_of_returns][i] = (returns >> bits) & mask;
      batch[CloudField::classification][i] = classification(point);
      if (las_.width_offset > 0) batch[CloudField::echo_width][i] = echo_width(point);
      if (las_.time_offset > 0) batch[CloudField::t][i] = number_at<double>(point, las_.time_offset);
    }
  }

 private:
  /// The withheld flag is bit 7 of the classification, or of formats 6 and later bit 2 of the flags. LAS 1.0
  /// has no flags: all bits are those of the class.
  [[nodiscard]] double classification(std::span<const std::byte> point) const {
    const unsigned value = number_at<std::uint8_t>(point, las_.is_extended() ? 16 : 15);
    if (las_.is_extended()) return (number_at<std::uint8_t>(point, 15) & 4U) != 0 ? kWithheld : value;
    if (las_.minor == 0) return value;
    return (value & 0x80U) != 0 ? kWithheld : value & 31U;
  }

  /// NaN for a width of 0: it was not measured.
  [[nodiscard]] double echo_width(std::span<const std::byte> point) const {
    const double width = number_at<std::uint16_t>(point, las_.width_offset);
    return width > 0 ? width * las_.width_m : std::numeric_limits<double>::quiet_NaN();
  }

  LasHeader las_;
};

}  // namespace

std::unique_ptr<CloudReader> open_las(std::unique_ptr<CloudBytes> file) {
  const LasHeader las = read_las_header(*file);
  return std::make_unique<LasReader>(std::move(file), las);
}

}  // namespace landfall
