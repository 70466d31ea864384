// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D170
//
// `landfall-info` leaves out statistics of chunks with more than 2^24 values. HDF5 decodes a whole chunk
// for any part of it. Chunks of up to that size are decoded once, which bounds the time by the size of the
// data and the memory by 0.5 GiB.
#include "store/hdf5/value_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <optional>
#include <vector>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "store/hdf5/chunk_source.h"

namespace landfall {
namespace {

/// Values per block of a dataset without chunks, or with too small ones.
constexpr hsize_t kBlockValues = 65536;
constexpr hsize_t kMaxParallel = hsize_t{1} << 21U;  ///< values of blocks that all threads hold
constexpr hsize_t kSmallestChunk = 1024;
constexpr double kMaxValues = 0x1p40;

using Extent = std::array<hsize_t, 2>;  ///< rows and columns; one column for a dataset of one dimension

/// A dataset cut into blocks, in row-major order.
class Blocks {
 public:
  Blocks(hid_t dataset, std::string file, std::string name)
      : dataset_(dataset), file_(std::move(file)), name_(std::move(name)), bytes_(dataset) {
    const h5::Handle space(H5Dget_space(dataset), H5Sclose);
    rank_ = H5Sget_simple_extent_ndims(space.get());
    if (rank_ != 1 && rank_ != 2) fail("it has neither 1 nor 2 dimensions");
    H5Sget_simple_extent_dims(space.get(), size_.data(), nullptr);
    if (static_cast<double>(size_[0]) * static_cast<double>(size_[1]) > kMaxValues)
      fail("it claims more than 2^40 values");
    choose_block();
    const h5::Handle type(H5Dget_type(dataset), H5Tclose);
    is_int8_ = H5Tequal(type.get(), H5T_STD_I8LE) > 0;
  }

  /// False if a block would need too much memory.
  [[nodiscard]] bool readable() const { return block_values() <= static_cast<double>(kMaxChunkValues); }
  /// Whether there is memory for one block per thread.
  [[nodiscard]] bool parallel() const { return block_values() <= static_cast<double>(kMaxParallel); }
  [[nodiscard]] std::size_t count() const { return per_axis(0) * per_axis(1); }
  [[nodiscard]] bool is_int8() const { return is_int8_; }

  /// The values of a block; several threads may read at once.
  void read(std::size_t block, std::vector<double>& values) const {
    const Extent first = {block / per_axis(1) * block_[0], block % per_axis(1) * block_[1]};
    const Extent extent = {std::min(block_[0], size_[0] - first[0]),
                           std::min(block_[1], size_[1] - first[1])};
    values.resize(extent[0] * extent[1]);
    if (!decode(first, extent, values)) read_plainly(first, extent, values);
  }

 private:
  [[nodiscard]] double block_values() const {
    return static_cast<double>(block_[0]) * static_cast<double>(block_[1]);
  }

  [[nodiscard]] std::size_t per_axis(std::size_t axis) const {
    return (size_[axis] + block_[axis] - 1) / block_[axis];
  }

  void choose_block() {
    const h5::Handle properties(H5Dget_create_plist(dataset_), H5Pclose);
    const bool chunked = H5Pget_layout(properties.get()) == H5D_CHUNKED &&
                         H5Pget_chunk(properties.get(), rank_, block_.data()) == rank_;
    const bool is_whole = block_[0] >= size_[0] && block_[1] >= size_[1];
    if (chunked && (is_whole || block_values() >= static_cast<double>(kSmallestChunk))) {
      chunks_ = decodable_chunks(dataset_, std::span(block_).first(static_cast<std::size_t>(rank_)));
      return;
    }
    block_[1] = std::clamp<hsize_t>(size_[1], 1, kBlockValues);
    block_[0] = std::clamp<hsize_t>(size_[0], 1, kBlockValues / block_[1]);
  }

  /// False if only HDF5 itself can read the block.
  bool decode(const Extent& first, const Extent& extent, std::span<double> values) const {
    if (!chunks_) return false;
    thread_local StoredChunk stored;
    thread_local std::vector<std::byte> elements;
    if (!bytes_.load(dataset_, std::span(first).first(static_cast<std::size_t>(rank_)), stored)) return false;
    elements.resize(chunks_->format.byte_count());
    if (!decode_chunk(stored.bytes, stored.filter_mask, chunks_->format, 0, elements))
      fail("the chunk at row " + std::to_string(first[0]) + " is corrupt");
    switch (chunks_->type) {
      case h5::Type::float64:
        convert<double>(elements, extent, values);
        break;
      case h5::Type::float32:
        convert<float>(elements, extent, values);
        break;
      case h5::Type::int64:
        convert<std::int64_t>(elements, extent, values);
        break;
      case h5::Type::int32:
        convert<std::int32_t>(elements, extent, values);
        break;
      case h5::Type::int8:
        convert<std::int8_t>(elements, extent, values);
        break;
    }
    return true;
  }

  /// The part of a chunk that lies in the dataset.
  template <class T>
  void convert(std::span<const std::byte> elements, const Extent& extent, std::span<double> values) const {
    for (hsize_t row = 0; row < extent[0]; ++row)
      for (hsize_t col = 0; col < extent[1]; ++col) {
        T value;
        std::memcpy(&value, elements.data() + (row * block_[1] + col) * sizeof value, sizeof value);
        values[row * extent[1] + col] = static_cast<double>(value);
      }
  }

  void read_plainly(const Extent& first, const Extent& extent, std::span<double> values) const {
    const std::lock_guard lock(h5::library_lock());
    const auto count = std::span(extent).first(static_cast<std::size_t>(rank_));
    if (!h5::read_block(dataset_, H5T_NATIVE_DOUBLE, first, count, values.data()))
      fail(h5::reading_failure());
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw FormatError(file_ + ": reading " + name_ + " failed: " + why);
  }

  hid_t dataset_;
  std::string file_;
  std::string name_;
  ChunkFile bytes_;
  int rank_ = 0;
  bool is_int8_ = false;
  Extent size_ = {0, 1};
  Extent block_ = {1, 1};
  std::optional<DecodableChunks> chunks_;
};

void count_int8(std::span<const double> values, ValueStatistics& statistics) {
  for (const double value : values) ++statistics.int8_counts[static_cast<std::size_t>(value + 128)];
}

}  // namespace

double ValueStatistics::std() const {
  return count == 0 ? 0 : std::sqrt(std::max(0.0, squares) / static_cast<double>(count));
}

void ValueStatistics::add(const ValueStatistics& other) {
  nan_count += other.nan_count;
  infinite_count += other.infinite_count;
  for (std::size_t i = 0; i < int8_counts.size(); ++i) int8_counts[i] += other.int8_counts[i];
  if (other.count == 0) return;
  min = count == 0 ? other.min : std::min(min, other.min);
  max = count == 0 ? other.max : std::max(max, other.max);
  const auto before = static_cast<double>(count);
  const auto more = static_cast<double>(other.count);
  const double shift = other.mean - mean;
  mean += shift * (more / (before + more));
  squares += other.squares + shift * shift * (before * more / (before + more));
  count += other.count;
}

ValueStatistics statistics_of(std::span<const double> values) {
  ValueStatistics result;
  result.min = std::numeric_limits<double>::infinity();
  result.max = -result.min;
  double sum = 0;
  for (const double value : values) {
    if (std::isfinite(value)) {
      ++result.count;
      sum += value;
      result.min = std::min(result.min, value);
      result.max = std::max(result.max, value);
    } else {
      ++(std::isnan(value) ? result.nan_count : result.infinite_count);
    }
  }
  if (result.count == 0) {
    result.min = result.max = 0;
    return result;
  }
  result.mean = sum / static_cast<double>(result.count);
  for (const double value : values)
    if (std::isfinite(value)) result.squares += (value - result.mean) * (value - result.mean);
  return result;
}

std::optional<ValueStatistics> dataset_statistics(hid_t dataset, const std::string& file,
                                                  const std::string& name, const ProgressCallback& progress) {
  const Blocks blocks(dataset, file, name);
  if (!blocks.readable()) return std::nullopt;
  struct Slot {
    std::vector<double> values;
    ValueStatistics statistics;
  };
  std::vector<Slot> slots(thread_count() + 2);
  ValueStatistics total;
  const auto compute = [&](std::size_t block, std::size_t number) {
    Slot& slot = slots[number];
    blocks.read(block, slot.values);
    slot.statistics = statistics_of(slot.values);
    if (blocks.is_int8()) count_int8(slot.values, slot.statistics);
  };
  // In the order of the blocks, so that sums do not depend on the threads.
  const auto add = [&](std::size_t block, std::size_t number) {
    total.add(slots[number].statistics);
    report(progress, static_cast<double>(block + 1) / static_cast<double>(blocks.count()));
  };
  if (blocks.parallel()) {
    produce_in_parallel(blocks.count(), slots.size(), compute, add);
  } else {
    for (std::size_t block = 0; block < blocks.count(); ++block) {
      compute(block, 0);
      add(block, 0);
    }
  }
  if (blocks.count() == 0) report(progress, 1);
  return total;
}

}  // namespace landfall
