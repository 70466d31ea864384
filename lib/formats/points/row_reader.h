// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "base/text/stored_number.h"
#include "formats/points/cloud_bytes.h"
#include "formats/points/cloud_formats.h"
#include "formats/points/cloud_reader.h"

namespace landfall {

/// Points that a file reads at a time: fewer where their rows would take more bytes than this.
inline constexpr std::size_t kCloudBatchPoints = std::size_t{1} << 16U;
inline constexpr std::size_t kMaxBatchBytes = std::size_t{1} << 25U;

/// A number in each row of a binary file.
struct RowColumn {
  std::string name;
  NumberType type;
  std::size_t offset;  ///< bytes from the beginning of the row
};

/// CloudInfo::time_base of times of this type, the first of which is in these bytes; only 64 bits need one.
[[nodiscard]] std::int64_t stored_time_base(NumberType type, const std::byte* first, bool is_big_endian);

/// The number in these bytes; of times from their base, unless that is 0.
[[nodiscard]] inline double number_from(std::int64_t base, NumberType type, const std::byte* bytes,
                                        bool is_big_endian) {
  if (base == 0) return stored_number(type, bytes, is_big_endian);
  return time_from(base, stored_number_of<std::int64_t, std::int64_t>(bytes, is_big_endian));
}

/// Rows of equal length.
struct RowLayout {
  std::uint64_t begin = 0;   ///< offset of the first row in the file
  std::size_t row_size = 0;  ///< bytes
  std::uint64_t count = 0;
  bool is_big_endian = false;
  std::vector<RowColumn> columns;
};

/// Throws FormatError unless the file holds all rows, naming the count and what there is.
void require_rows(const CloudBytes& file, const RowLayout& layout);

/// Judges the bytes of a file that belong neither to its rows nor to anything else that it declares. Throws
/// FormatError where they make whole rows, which the header then does not count; returns a sentence about
/// other bytes, or an empty text for none.
[[nodiscard]] std::string judge_rest(const CloudBytes& file, const RowLayout& layout, std::uint64_t rest);

/// Reads rows of a binary file batch by batch; a derived class decodes them.
class RowReader : public CloudReader {
 public:
  bool next(CloudBatch& batch) override;
  void rewind() override { next_ = 0; }
  [[nodiscard]] double progress() const override {
    return static_cast<double>(next_) / static_cast<double>(layout_.count);
  }

 protected:
  /// require_rows() of the layout, at least one.
  RowReader(std::unique_ptr<CloudBytes> file, RowLayout layout);
  /// Decodes the rows [begin, end) of `bytes`, a batch; from several threads.
  virtual void decode(std::span<const std::byte> bytes, std::size_t begin, std::size_t end,
                      CloudBatch& batch) const = 0;
  [[nodiscard]] const CloudBytes& file() const { return *file_; }
  [[nodiscard]] const RowLayout& layout() const { return layout_; }

 private:
  std::unique_ptr<CloudBytes> file_;
  RowLayout layout_;
  std::uint64_t next_ = 0;
  std::vector<std::byte> bytes_;
};

/// A reader of rows whose columns are RowColumns, which `info.columns` numbers.
[[nodiscard]] std::unique_ptr<CloudReader> read_rows(std::unique_ptr<CloudBytes> file, RowLayout layout,
                                                     CloudInfo info);

}  // namespace landfall
