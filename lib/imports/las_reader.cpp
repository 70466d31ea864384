// SPDX-License-Identifier: GPL-3.0-or-later
// LAS 1.0 to 1.4 (ASPRS). Colours, waveform packets and extra bytes of a point are skipped.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "imports/cloud_formats.h"
#include "imports/row_reader.h"

namespace landfall {
namespace {

constexpr std::size_t kHeader = 227;  // of LAS 1.0 to 1.2; 1.3 has 235, 1.4 375
constexpr std::size_t kHeader14 = 375;
constexpr std::size_t kRecordHead = 54;
constexpr std::size_t kLongRecordHead = 60;
constexpr std::size_t kMaxCrsBytes = 1U << 20U;

/// Bytes of a point and offset of its GPS time (0: none), by point format.
struct PointFormat {
  std::size_t bytes;
  std::size_t time;
};
constexpr std::array<PointFormat, 11> kPointFormats = {{{20, 0},
                                                        {28, 20},
                                                        {26, 0},
                                                        {34, 20},
                                                        {57, 20},
                                                        {63, 20},
                                                        {30, 22},
                                                        {36, 22},
                                                        {38, 22},
                                                        {59, 22},
                                                        {67, 22}}};

struct LasHeader {
  int minor = 0;
  std::uint8_t format = 0;
  std::uint16_t encoding = 0;
  std::size_t size = 0;
  std::uint32_t record_count = 0;
  std::uint64_t long_records = 0;  ///< offset
  std::uint32_t long_record_count = 0;
  RowLayout rows;
  CloudSteps steps{};
};

[[noreturn]] void refuse_laz(const CloudBytes& file) {
  file.fail("is compressed LAS (LAZ): unpack it first, with pdal translate " + file.name() +
            " points.las, or laszip -i " + file.name() + " -o points.las");
}

std::uint64_t point_count(const std::vector<std::byte>& head, int minor) {
  const std::uint64_t legacy = number_at<std::uint32_t>(head, 107);
  if (minor < 4) return legacy;
  const auto count = number_at<std::uint64_t>(head, 247);
  return count > 0 ? count : legacy;
}

void read_point_layout(const CloudBytes& file, const std::vector<std::byte>& head, LasHeader& las) {
  las.format = number_at<std::uint8_t>(head, 104);
  if ((las.format & 0xc0U) != 0) refuse_laz(file);
  if (las.format >= kPointFormats.size())
    file.fail("has point format " + std::to_string(las.format) + "; LAS has 0 to 10");
  las.rows.begin = number_at<std::uint32_t>(head, 96);
  las.rows.row_size = number_at<std::uint16_t>(head, 105);
  las.rows.count = point_count(head, las.minor);
  const std::size_t least = kPointFormats[las.format].bytes;
  if (las.rows.row_size < least)
    file.fail("declares points of " + std::to_string(las.rows.row_size) + " bytes; those of format " +
              std::to_string(las.format) + " have " + std::to_string(least));
  if (las.rows.begin < las.size)
    file.fail("its points begin at byte " + std::to_string(las.rows.begin) + ", within its header of " +
              std::to_string(las.size) + " bytes");
}

void read_steps(const CloudBytes& file, const std::vector<std::byte>& head, CloudSteps& steps) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    steps.scale[axis] = number_at<double>(head, 131 + 8 * axis);
    steps.offset[axis] = number_at<double>(head, 155 + 8 * axis);
    if (!std::isfinite(steps.scale[axis]) || steps.scale[axis] == 0 || !std::isfinite(steps.offset[axis]))
      file.fail("its scale or offset of axis " + std::string(1, "xyz"[axis]) + " is 0 or not finite");
  }
}

LasHeader read_las_header(const CloudBytes& file) {
  const std::vector<std::byte> head = file.up_to(0, kHeader14);
  if (head.size() < kHeader) file.fail("ends within its header");
  LasHeader las;
  const auto major = number_at<std::uint8_t>(head, 24);
  las.minor = number_at<std::uint8_t>(head, 25);
  if (major != 1 || las.minor > 4)
    file.fail("is LAS " + std::to_string(major) + "." + std::to_string(las.minor) + "; 1.0 to 1.4 are read");
  las.size = number_at<std::uint16_t>(head, 94);
  const std::size_t least = las.minor == 4 ? kHeader14 : kHeader;
  if (las.size < least || head.size() < least)
    file.fail("declares a header of " + std::to_string(las.size) + " bytes; LAS 1." +
              std::to_string(las.minor) + " has at least " + std::to_string(least));
  if (las.minor > 0) las.encoding = number_at<std::uint16_t>(head, 6);
  las.record_count = number_at<std::uint32_t>(head, 100);
  if (las.minor == 4) {
    las.long_records = number_at<std::uint64_t>(head, 235);
    las.long_record_count = number_at<std::uint32_t>(head, 243);
  }
  read_point_layout(file, head, las);
  read_steps(file, head, las.steps);
  return las;
}

/// The records that describe the CRS.
class CrsRecords {
 public:
  CrsRecords(const CloudBytes& file, const LasHeader& las) : file_(file) {
    std::uint64_t at = las.size;
    for (std::uint32_t i = 0; i < las.record_count; ++i) at = short_record(at, las.rows.begin);
    at = las.long_records;
    for (std::uint32_t i = 0; i < las.long_record_count; ++i) at = long_record(at);
  }

  /// Bit 4 of the global encoding says that the CRS is WKT.
  void put(const LasHeader& las, CloudInfo& info) const {
    const bool says_wkt = (las.encoding & 0x10U) != 0;
    if (!wkt_.empty() && (says_wkt || keys_.directory.empty()))
      info.crs_wkt = wkt_;
    else if (!keys_.directory.empty())
      info.geo_keys = keys_;
  }

 private:
  std::uint64_t short_record(std::uint64_t at, std::uint64_t end) {
    if (at + kRecordHead > end) refuse(at);
    const std::vector<std::byte> head = file_.up_to(at, kRecordHead);
    if (head.size() < kRecordHead) refuse(at);
    const std::size_t length = number_at<std::uint16_t>(head, 20);
    if (at + kRecordHead + length > end) refuse(at);
    take(head, at + kRecordHead, length);
    return at + kRecordHead + length;
  }

  std::uint64_t long_record(std::uint64_t at) {
    const std::vector<std::byte> head = file_.up_to(at, kLongRecordHead);
    if (head.size() < kLongRecordHead) refuse(at);
    const auto length = number_at<std::uint64_t>(head, 20);
    if (length > file_.size() - at - kLongRecordHead) refuse(at);
    take(head, at + kLongRecordHead, length);
    return at + kLongRecordHead + length;
  }

  void take(const std::vector<std::byte>& head, std::uint64_t at, std::uint64_t length) {
    const std::string user = text_at(head, 2, 16);
    if (user == "laszip encoded") refuse_laz(file_);
    if (user != "LASF_Projection" || length > kMaxCrsBytes) return;
    const std::vector<std::byte> bytes = file_.up_to(at, static_cast<std::size_t>(length));
    if (bytes.size() < length) refuse(at);
    switch (number_at<std::uint16_t>(head, 18)) {
      case 2112:
        wkt_ = text_at(bytes, 0, bytes.size());
        break;
      case 34735:
        keys_.directory = numbers<std::uint16_t>(bytes);
        break;
      case 34736:
        keys_.numbers = numbers<double>(bytes);
        break;
      case 34737:
        keys_.texts = text_at(bytes, 0, bytes.size());
        break;
      default:
        break;
    }
  }

  template <class T>
  static std::vector<T> numbers(const std::vector<std::byte>& bytes) {
    std::vector<T> result;
    for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T))
      result.push_back(number_at<T>(bytes, at));
    return result;
  }

  [[noreturn]] void refuse(std::uint64_t at) const {
    file_.fail("its variable-length record at byte " + std::to_string(at) +
               " reaches beyond its place: the file is damaged");
  }

  const CloudBytes& file_;
  std::string wkt_;
  CloudGeoKeys keys_;
};

class LasReader final : public RowReader {
 public:
  LasReader(std::unique_ptr<CloudBytes> bytes, const LasHeader& las)
      : RowReader(std::move(bytes), las.rows), las_(las) {
    info_.format = "LAS 1." + std::to_string(las.minor) + ", point format " + std::to_string(las.format);
    for (const CloudField field : {CloudField::x, CloudField::y, CloudField::z, CloudField::intensity,
                                   CloudField::return_number, CloudField::classification})
      info_.columns[static_cast<std::size_t>(field)] = 0;
    if (time_offset() > 0) {
      info_.columns[static_cast<std::size_t>(CloudField::t)] = 0;
      info_.clock = (las.encoding & 1U) != 0 ? "adjusted standard GPS time: GPS seconds - 1e9"
                                             : "GPS seconds of the week, or since the first pulse";
    }
    info_.point_count = static_cast<std::int64_t>(las.rows.count);
    info_.steps = las.steps;
    CrsRecords(file(), las).put(las, info_);
  }

 protected:
  void decode(std::span<const std::byte> bytes, std::size_t begin, std::size_t end,
              CloudBatch& batch) const override {
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<const std::byte> point = bytes.subspan(i * las_.rows.row_size, las_.rows.row_size);
      for (std::size_t axis = 0; axis < 3; ++axis)
        batch.columns[axis][i] =
            number_at<std::int32_t>(point, 4 * axis) * las_.steps.scale[axis] + las_.steps.offset[axis];
      batch[CloudField::intensity][i] = number_at<std::uint16_t>(point, 12);
      const unsigned flags = number_at<std::uint8_t>(point, 14);
      batch[CloudField::return_number][i] = flags & (is_extended() ? 15U : 7U);
      batch[CloudField::classification][i] = classification(point);
      if (time_offset() > 0) batch[CloudField::t][i] = number_at<double>(point, time_offset());
    }
  }

 private:
  [[nodiscard]] bool is_extended() const { return las_.format >= 6; }
  [[nodiscard]] std::size_t time_offset() const { return kPointFormats[las_.format].time; }

  /// The withheld flag is bit 7 of the classification, or of formats 6 and later bit 2 of the flags.
  [[nodiscard]] double classification(std::span<const std::byte> point) const {
    const unsigned value = number_at<std::uint8_t>(point, is_extended() ? 16 : 15);
    if (is_extended()) return (number_at<std::uint8_t>(point, 15) & 4U) != 0 ? kWithheld : value;
    if (las_.minor == 0) return value;
    return (value & 0x80U) != 0 ? kWithheld : value & 31U;
  }

  LasHeader las_;
};

}  // namespace

std::unique_ptr<CloudReader> open_las(std::unique_ptr<CloudBytes> file) {
  const LasHeader las = read_las_header(*file);
  return std::make_unique<LasReader>(std::move(file), las);
}

}  // namespace landfall
