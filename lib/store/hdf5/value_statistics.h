// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "base/core/progress.h"
#include "store/hdf5/h5.h"

namespace landfall {

/// Statistics of the values of a layer or column. Only finite values count in least, greatest, mean and
/// standard deviation; without any these are 0.
struct ValueStatistics {
  std::int64_t count = 0;  ///< finite values
  std::int64_t nan_count = 0;
  std::int64_t infinite_count = 0;
  double min = 0;
  double max = 0;
  double mean = 0;
  double squares = 0;  ///< sum of squared deviations from the mean
  /// Number of occurrences of each value of an int8, from -128; all 0 for other types.
  std::array<std::int64_t, 256> int8_counts = {};

  /// Population standard deviation.
  [[nodiscard]] double std() const;
  /// Adds the statistics of further values (Chan, Golub and LeVeque 1979).
  void add(const ValueStatistics& other);
};

/// Statistics of a span of values. The deviations are taken from their mean in a second pass.
[[nodiscard]] ValueStatistics statistics_of(std::span<const double> values);

/// Chunks of more values are not read.
inline constexpr std::int64_t kMaxChunkValues = std::int64_t{1} << 24U;

/// Statistics of all values of a numeric dataset of 1 or 2 dimensions; nothing if its chunks have more than
/// kMaxChunkValues. It is read block by block on all threads, by its chunks if these can be decoded without
/// HDF5; at most 32 MiB per thread are held. A chunk of more than 2^21 values is a block, so that it is
/// decoded once, and such blocks are read one after the other: at most 0.5 GiB are held. The result does not
/// depend on the number of threads. `file` and `name` are for messages. Throws FormatError if a block cannot
/// be read, or the dataset claims more than 2^40 values.
[[nodiscard]] std::optional<ValueStatistics> dataset_statistics(hid_t dataset, const std::string& file,
                                                                const std::string& name,
                                                                const ProgressCallback& progress = {});

}  // namespace landfall
