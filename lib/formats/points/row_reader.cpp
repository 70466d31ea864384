// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/row_reader.h"

#include <algorithm>
#include <utility>

#include "base/core/parallel.h"

namespace landfall {
namespace {

constexpr std::size_t kRowsPerTask = 1U << 14U;

class PlainRowReader final : public RowReader {
 public:
  PlainRowReader(std::unique_ptr<CloudBytes> file, RowLayout layout, CloudInfo info)
      : RowReader(std::move(file), std::move(layout)) {
    info_ = std::move(info);
    info_.point_count = static_cast<std::int64_t>(this->layout().count);
    if (!info_.has(CloudField::t)) return;
    const RowColumn& times = this->layout().columns[*info_.columns[kTimeField]];
    const std::vector<std::byte> first =
        this->file().up_to(this->layout().begin + times.offset, size_of(times.type));
    info_.time_base = stored_time_base(times.type, first.data(), this->layout().is_big_endian);
  }

 protected:
  void decode(std::span<const std::byte> bytes, std::size_t begin, std::size_t end,
              CloudBatch& batch) const override {
    for (std::size_t f = 0; f < kCloudFieldCount; ++f) {
      if (!info_.columns[f]) continue;
      const RowColumn& column = layout().columns[*info_.columns[f]];
      const std::byte* at = bytes.data() + begin * layout().row_size + column.offset;
      const std::int64_t base = f == kTimeField ? info_.time_base : 0;
      for (std::size_t i = begin; i < end; ++i, at += layout().row_size)
        batch.columns[f][i] = number_from(base, column.type, at, layout().is_big_endian);
    }
  }
};

}  // namespace

std::int64_t stored_time_base(NumberType type, const std::byte* first, bool is_big_endian) {
  if (type != NumberType::int64 && type != NumberType::uint64) return 0;
  return time_base(stored_number_of<std::int64_t, std::int64_t>(first, is_big_endian));
}

void require_rows(const CloudBytes& file, const RowLayout& layout) {
  if (layout.count == 0) file.fail("has no points");
  const std::uint64_t left = file.size() > layout.begin ? file.size() - layout.begin : 0;
  const std::uint64_t rows = layout.row_size > 0 ? left / layout.row_size : 0;
  if (rows < layout.count)
    file.fail("declares " + std::to_string(layout.count) + " points, but has the bytes of " +
              std::to_string(rows) + ": it is truncated, or its header is wrong");
}

std::string judge_rest(const CloudBytes& file, const RowLayout& layout, std::uint64_t rest) {
  if (rest == 0) return "";
  if (rest % layout.row_size == 0)
    file.fail("declares " + std::to_string(layout.count) + " points, but the bytes of " +
              std::to_string(rest / layout.row_size) +
              " more follow: its header is wrong; write it again with the program that made it");
  return "has " + std::to_string(rest) +
         " bytes that belong to nothing that its header declares; they are not read";
}

RowReader::RowReader(std::unique_ptr<CloudBytes> file, RowLayout layout)
    : file_(std::move(file)), layout_(std::move(layout)) {
  require_rows(*file_, layout_);
}

bool RowReader::next(CloudBatch& batch) {
  const std::size_t rows_in_bytes = std::max<std::size_t>(kMaxBatchBytes / layout_.row_size, 1);
  const auto count = static_cast<std::size_t>(
      std::min<std::uint64_t>(std::min(kCloudBatchPoints, rows_in_bytes), layout_.count - next_));
  if (count == 0) return false;
  bytes_.resize(count * layout_.row_size);
  file_->read(layout_.begin + next_ * layout_.row_size, bytes_);
  for (std::size_t f = 0; f < kCloudFieldCount; ++f) batch.columns[f].resize(info_.columns[f] ? count : 0);
  parallel_for(count, kRowsPerTask,
               [&](std::size_t begin, std::size_t end) { decode(bytes_, begin, end, batch); });
  next_ += count;
  return true;
}

std::unique_ptr<CloudReader> read_rows(std::unique_ptr<CloudBytes> file, RowLayout layout, CloudInfo info) {
  return std::make_unique<PlainRowReader>(std::move(file), std::move(layout), std::move(info));
}

}  // namespace landfall
