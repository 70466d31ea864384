// SPDX-License-Identifier: GPL-3.0-or-later
// LAS 1.0 to 1.4 (ASPRS).
#include "formats/points/las_header.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/numerics/light.h"

namespace landfall {
namespace {

constexpr std::size_t kHeader = 227;  // of LAS 1.0 to 1.2; 1.3 has 235, 1.4 375
constexpr std::size_t kHeader13 = 235;
constexpr std::size_t kHeader14 = 375;
constexpr std::size_t kRecordHead = 54;
constexpr std::size_t kLongRecordHead = 60;
constexpr std::size_t kMaxRecordBytes = 1U << 20U;  // of records that describe the CRS or extra bytes
constexpr std::size_t kExtraBytes = 192;            // of the description of one extra field
constexpr const char* kWidthWords = "Full width at half maximum [ns]";

// By point format: bytes of a point, and offset of its GPS time (0: none).
constexpr std::array<std::size_t, 11> kPointBytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::array<std::size_t, 11> kTimeOffsets = {0, 20, 0, 20, 20, 20, 22, 22, 22, 22, 22};

/// The places of a header's records.
struct LasRecords {
  std::uint64_t begin = 0;
  std::uint32_t count = 0;
  std::uint64_t long_begin = 0;
  std::uint32_t long_count = 0;
  std::uint64_t waveforms = 0;  ///< of their record; 0: none
  bool says_wkt = false;        ///< bit 4 of the global encoding
};

[[noreturn]] void refuse_laz(const CloudBytes& file) {
  file.fail("is compressed LAS (LAZ): unpack it first, with pdal translate " + file.name() +
            " points.las, or laszip -i " + file.name() + " -o points.las");
}

/// The sum of `count` counts by return; 2^63 where it is larger.
template <class T>
std::uint64_t sum_of_counts(const std::vector<std::byte>& head, std::size_t at, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += static_cast<double>(number_at<T>(head, at + sizeof(T) * i));
  return sum < 0x1p63 ? static_cast<std::uint64_t>(sum) : std::uint64_t{1} << 63U;
}

void read_counts(const CloudBytes& file, const std::vector<std::byte>& head, LasHeader& las) {
  const std::uint64_t legacy = number_at<std::uint32_t>(head, 107);
  const std::uint64_t count = las.minor == 4 ? number_at<std::uint64_t>(head, 247) : legacy;
  if (legacy != 0 && count != 0 && legacy != count)
    file.fail("declares " + std::to_string(legacy) + " points in 32 bits, but " + std::to_string(count) +
              " in 64 bits: its header is wrong; write it again with the program that made it");
  las.rows.count = std::max(count, legacy);
  const std::uint64_t by_return =
      std::max(sum_of_counts<std::uint32_t>(head, 111, 5),
               las.minor == 4 ? sum_of_counts<std::uint64_t>(head, 255, 15) : std::uint64_t{0});
  if (by_return > las.rows.count && las.rows.count > 0)
    file.fail("declares " + std::to_string(las.rows.count) + " points, but " + std::to_string(by_return) +
              " by return: its header is wrong; write it again with the program that made it");
}

void read_point_layout(const CloudBytes& file, const std::vector<std::byte>& head, std::size_t header_size,
                       LasHeader& las) {
  las.format = number_at<std::uint8_t>(head, 104);
  if ((las.format & 0xc0U) != 0) refuse_laz(file);
  if (las.format >= kPointBytes.size())
    file.fail("has point format " + std::to_string(las.format) + "; LAS has 0 to 10");
  las.time_offset = kTimeOffsets[las.format];
  las.rows.begin = number_at<std::uint32_t>(head, 96);
  las.rows.row_size = number_at<std::uint16_t>(head, 105);
  const std::size_t minimum = kPointBytes[las.format];
  if (las.rows.row_size < minimum)
    file.fail("declares points of " + std::to_string(las.rows.row_size) + " bytes; those of format " +
              std::to_string(las.format) + " have " + std::to_string(minimum));
  if (las.rows.begin < header_size)
    file.fail("its points begin at byte " + std::to_string(las.rows.begin) + ", within its header of " +
              std::to_string(header_size) + " bytes");
}

void read_steps_and_box(const CloudBytes& file, const std::vector<std::byte>& head, LasHeader& las) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    las.steps.scale[axis] = number_at<double>(head, 131 + 8 * axis);
    las.steps.offset[axis] = number_at<double>(head, 155 + 8 * axis);
    las.box.high[axis] = number_at<double>(head, 179 + 16 * axis);
    las.box.low[axis] = number_at<double>(head, 187 + 16 * axis);
    if (!std::isfinite(las.steps.scale[axis]) || las.steps.scale[axis] == 0 ||
        !std::isfinite(las.steps.offset[axis]))
      file.fail("its scale or offset of axis " + std::string(1, "xyz"[axis]) + " is 0 or not finite");
  }
}

/// Reads the records of a file into its header.
class RecordReader {
 public:
  RecordReader(const CloudBytes& file, const LasRecords& records, LasHeader& las)
      : file_(file), records_(records), las_(las) {}

  void read() {
    std::uint64_t at = records_.begin;
    for (std::uint32_t i = 0; i < records_.count; ++i) at = short_record(at, las_.rows.begin);
    require_records_behind_points();
    long_end_ = records_.long_begin;
    for (std::uint32_t i = 0; i < records_.long_count; ++i) long_end_ = long_record(long_end_);
    put_crs();
    require_extra_bytes();
  }

  /// Bytes behind the points that belong to no record. Requires rows that the file holds.
  [[nodiscard]] std::uint64_t bytes_left() const {
    const std::uint64_t end = points_end();
    const std::uint64_t begin = records_.waveforms;
    const bool is_separate = begin >= end && begin < file_.size() && !is_in_long_records(begin);
    const std::uint64_t of_records = records_.long_count > 0 ? long_end_ - records_.long_begin : 0;
    return file_.size() - end - of_records - (is_separate ? waveform_bytes(begin) : 0);
  }

 private:
  [[nodiscard]] std::uint64_t points_end() const {
    return las_.rows.begin + las_.rows.count * las_.rows.row_size;
  }

  void require_records_behind_points() const {
    if (records_.long_count > 0 && records_.long_begin < points_end())
      file_.fail("its points end at byte " + std::to_string(points_end()) +
                 ", but records behind them begin at byte " + std::to_string(records_.long_begin) +
                 ": its header is wrong");
  }

  [[nodiscard]] bool is_in_long_records(std::uint64_t at) const {
    return records_.long_count > 0 && at >= records_.long_begin && at < long_end_;
  }

  /// The record of waveforms; up to the end of the file, or to the other records, where it has no length.
  [[nodiscard]] std::uint64_t waveform_bytes(std::uint64_t begin) const {
    const bool is_before = records_.long_count > 0 && begin < records_.long_begin;
    const std::uint64_t room = (is_before ? records_.long_begin : file_.size()) - begin;
    const std::vector<std::byte> head = file_.up_to(begin, kLongRecordHead);
    if (head.size() < kLongRecordHead) return room;
    const auto length = number_at<std::uint64_t>(head, 20);
    return length == 0 || room < kLongRecordHead || length > room - kLongRecordHead
               ? room
               : length + kLongRecordHead;
  }

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
    if ((user != "LASF_Projection" && user != "LASF_Spec") || length > kMaxRecordBytes) return;
    const std::vector<std::byte> bytes = file_.up_to(at, static_cast<std::size_t>(length));
    if (bytes.size() < length) refuse(at);
    const auto number = number_at<std::uint16_t>(head, 18);
    if (user == "LASF_Spec" && number == 4) add_extra_bytes(bytes);
    if (user == "LASF_Projection") take_crs(number, bytes);
  }

  void take_crs(std::uint16_t number, const std::vector<std::byte>& bytes) {
    if (number == 2112) wkt_ = text_at(bytes, 0, bytes.size());
    if (number == 34735) keys_.directory = numbers<std::uint16_t>(bytes);
    if (number == 34736) keys_.numbers = numbers<double>(bytes);
    if (number == 34737) keys_.texts = text_at(bytes, 0, bytes.size());
  }

  /// A WKT of blanks is none: some programs write the record without a CRS.
  void put_crs() {
    const bool has_wkt = wkt_.find_first_not_of(" \t\r\n") != std::string::npos;
    if (has_wkt && (records_.says_wkt || keys_.directory.empty()))
      las_.crs_wkt = wkt_;
    else if (!keys_.directory.empty())
      las_.geo_keys = keys_;
  }

  /// Adds the sizes of the fields that a record of extra bytes describes.
  void add_extra_bytes(const std::vector<std::byte>& bytes) {
    constexpr std::array<std::size_t, 10> kSizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    for (std::size_t at = 0; at + kExtraBytes <= bytes.size(); at += kExtraBytes) {
      const std::size_t type = number_at<std::uint8_t>(bytes, at + 2);
      if (type == 3 && text_at(bytes, at + 160, 32) == kWidthWords) take_width(bytes, at);
      if (type == 0)
        extra_bytes_ += number_at<std::uint8_t>(bytes, at + 3);
      else if (type <= 30)  // 11 to 20 are pairs, 21 to 30 triples
        extra_bytes_ += kSizes[(type - 1) % 10] * ((type - 1) / 10 + 1);
    }
  }

  /// The width of echoes as RIEGL's programs write it: a number without offset, times a scale.
  void take_width(const std::vector<std::byte>& bytes, std::size_t at) {
    const unsigned options = number_at<std::uint8_t>(bytes, at + 3);
    const double scale = (options & 8U) != 0 ? number_at<double>(bytes, at + 112) : 1;
    if ((options & 16U) != 0 || !(scale > 0) || !std::isfinite(scale)) return;
    las_.width_offset = kPointBytes[las_.format] + extra_bytes_;
    las_.width_m = scale * range_of_time_m(1e-9) / std::sqrt(8 * std::numbers::ln2);
  }

  void require_extra_bytes() const {
    const std::size_t room = las_.rows.row_size - kPointBytes[las_.format];
    if (extra_bytes_ > room)
      file_.fail("declares points of " + std::to_string(las_.rows.row_size) + " bytes with " +
                 std::to_string(extra_bytes_) + " extra ones; those of format " +
                 std::to_string(las_.format) + " leave " + std::to_string(room));
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
  const LasRecords& records_;
  LasHeader& las_;
  std::uint64_t long_end_ = 0;
  std::string wkt_;
  CloudGeoKeys keys_;
  std::size_t extra_bytes_ = 0;
};

LasRecords read_records_place(const std::vector<std::byte>& head, int minor, std::size_t header_size) {
  const unsigned encoding = minor > 0 ? number_at<std::uint16_t>(head, 6) : 0U;
  LasRecords records{.begin = header_size,
                     .count = number_at<std::uint32_t>(head, 100),
                     .says_wkt = (encoding & 0x10U) != 0};
  if (minor >= 3 && std::min(header_size, head.size()) >= kHeader13)
    records.waveforms = number_at<std::uint64_t>(head, 227);
  if (minor == 4) {
    records.long_begin = number_at<std::uint64_t>(head, 235);
    records.long_count = number_at<std::uint32_t>(head, 243);
  }
  return records;
}

}  // namespace

LasHeader read_las_header(const CloudBytes& file) {
  const std::vector<std::byte> head = file.up_to(0, kHeader14);
  if (head.size() < kHeader) file.fail("ends within its header");
  LasHeader las;
  const auto major = number_at<std::uint8_t>(head, 24);
  las.minor = number_at<std::uint8_t>(head, 25);
  if (major != 1 || las.minor > 4)
    file.fail("is LAS " + std::to_string(major) + "." + std::to_string(las.minor) + "; 1.0 to 1.4 are read");
  const std::size_t size = number_at<std::uint16_t>(head, 94);
  const std::size_t minimum = las.minor == 4 ? kHeader14 : kHeader;
  if (size < minimum || head.size() < minimum)
    file.fail("declares a header of " + std::to_string(size) + " bytes; LAS 1." + std::to_string(las.minor) +
              " has at least " + std::to_string(minimum));
  las.has_gps_time_of_1980 = las.minor > 0 && (number_at<std::uint16_t>(head, 6) & 1U) != 0;
  read_point_layout(file, head, size, las);
  read_counts(file, head, las);
  read_steps_and_box(file, head, las);
  const LasRecords records = read_records_place(head, las.minor, size);
  require_rows(file, las.rows);
  RecordReader reader(file, records, las);
  reader.read();
  las.notes.push_back(judge_rest(file, las.rows, reader.bytes_left()));
  std::erase(las.notes, "");
  return las;
}

}  // namespace landfall
