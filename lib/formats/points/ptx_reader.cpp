// SPDX-License-Identifier: GPL-3.0-or-later
// PTX of Leica: scans of columns x rows points in the frame of the scanner, each with the transformation to
// the frame of the project. 0 0 0 is a pulse without a return.
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "formats/points/cloud_formats.h"
#include "formats/points/text_head.h"
#include "formats/points/text_rows.h"

namespace landfall {
namespace {

constexpr std::size_t kHeaderLines = 10;
constexpr std::size_t kHeaderBytes = std::size_t{1} << 14U;  ///< at most, with the first row

/// The header of a scan, whose points are (x, y, z, 1) times the matrix of these rows.
struct PtxHeader {
  std::int64_t count = 0;
  std::array<std::array<double, 4>, 4> rows{};
};

class PtxReader final : public CloudReader {
 public:
  explicit PtxReader(std::unique_ptr<CloudBytes> file) : file_(std::move(file)) {
    info_.format = "PTX";
    PtxReader::rewind();
    info_.columns = columns_of(column_count_);
  }

  bool next(CloudBatch& batch) override {
    while (!scan_->next(batch))
      if (!open_scan(scan_->position(), scan_->line())) return false;
    for (std::size_t i = 0; i < batch.size(); ++i)
      place(batch.columns[0][i], batch.columns[1][i], batch.columns[2][i]);
    return true;
  }
  void rewind() override {
    column_count_ = 0;
    if (!open_scan(0, 1)) file_->fail("has no points");
  }
  [[nodiscard]] double progress() const override { return scan_->progress(); }

 private:
  static CloudColumns columns_of(std::size_t count) {
    CloudColumns columns{0, 1, 2};
    if (count > 3) columns[static_cast<std::size_t>(CloudField::intensity)] = 3;
    return columns;
  }

  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    file_->fail("line " + std::to_string(line) + ": " + what);
  }

  /// Begins with the scan whose header is at an offset, the beginning of a line; false at the end of the
  /// file.
  bool open_scan(std::uint64_t at, std::size_t line) {
    const std::vector<std::byte> bytes = file_->up_to(at, kHeaderBytes);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const TextHead head = text_head(text, at + bytes.size() == file_->size());
    if (head.lines.empty()) return false;
    if (head.lines.size() < kHeaderLines)
      fail(line - 1 + head.lines.back().number,
           "the file ends within the header of a scan, which has 10 lines");
    header_ = header_of(head, line - 1);
    if (head.lines.size() == kHeaderLines)
      fail(line - 1 + head.lines.back().number, "the file ends before the points of its scan");
    const HeadLine& first = head.lines[kHeaderLines];
    if (column_count_ == 0) column_count_ = cells_of(first.text, ' ').size();
    if (column_count_ < 3)
      fail(line - 1 + first.number,
           "has " + std::to_string(column_count_) + " cells; a point has x, y and z");
    CloudInfo info;
    info.columns = columns_of(column_count_);
    scan_ = std::make_unique<TextReader>(std::make_unique<CloudBytes>(file_->name()),
                                         TextRows{.begin = at + first.at,
                                                  .first_line = line - 1 + first.number,
                                                  .count = header_.count,
                                                  .may_continue = true,
                                                  .column_count = column_count_},
                                         std::move(info));
    return true;
  }

  [[nodiscard]] PtxHeader header_of(const TextHead& head, std::size_t lines_before) const {
    PtxHeader header;
    const std::int64_t columns = count_in(head.lines[0], lines_before);
    const std::int64_t rows = count_in(head.lines[1], lines_before);
    if (rows > kMaxCount / columns) fail(lines_before + head.lines[1].number, "declares too many points");
    header.count = columns * rows;
    for (std::size_t i = 2; i < 6; ++i) static_cast<void>(numbers_in<3>(head.lines[i], lines_before));
    for (std::size_t i = 0; i < 4; ++i) {
      header.rows[i] = numbers_in<4>(head.lines[6 + i], lines_before);
      if (header.rows[i][3] != (i == 3 ? 1 : 0))
        fail(lines_before + head.lines[6 + i].number, "the last column of a transformation is 0, 0, 0, 1: " +
                                                          std::string(trimmed(head.lines[6 + i].text)));
    }
    return header;
  }

  [[nodiscard]] std::int64_t count_in(const HeadLine& line, std::size_t lines_before) const {
    const auto count = whole_number(trimmed(line.text));
    if (!count || *count < 1 || *count > kMaxCount)
      fail(lines_before + line.number,
           "a scan begins with the numbers of its columns and rows, on lines of their own");
    return *count;
  }

  template <std::size_t Count>
  [[nodiscard]] std::array<double, Count> numbers_in(const HeadLine& line, std::size_t lines_before) const {
    std::array<double, Count> numbers{};
    bool good = true;
    const std::size_t count = for_each_cell(line.text, ' ', [&](std::size_t i, std::string_view cell) {
      const auto value = cell_value(cell, false);
      good = good && value && std::isfinite(*value);
      if (good && i < Count) numbers[i] = *value;
    });
    if (!good || count != Count)
      fail(lines_before + line.number,
           "this line of a scan's header has " + std::to_string(Count) + " numbers");
    return numbers;
  }

  void place(double& x, double& y, double& z) const {
    const bool has_return = x != 0 || y != 0 || z != 0;
    const auto axis = [&rows = header_.rows, p = std::array{x, y, z}](std::size_t k) {
      return p[0] * rows[0][k] + p[1] * rows[1][k] + p[2] * rows[2][k] + rows[3][k];
    };
    x = has_return ? axis(0) : std::numeric_limits<double>::quiet_NaN();
    y = axis(1);
    z = axis(2);
  }

  static constexpr std::int64_t kMaxCount = std::int64_t{1} << 48U;

  std::unique_ptr<CloudBytes> file_;
  PtxHeader header_;
  std::size_t column_count_ = 0;
  std::unique_ptr<TextReader> scan_;
};

}  // namespace

std::unique_ptr<CloudReader> open_ptx(std::unique_ptr<CloudBytes> file) {
  return std::make_unique<PtxReader>(std::move(file));
}

}  // namespace landfall
