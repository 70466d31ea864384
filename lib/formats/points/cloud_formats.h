// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "base/text/stored_number.h"
#include "formats/points/cloud_bytes.h"
#include "formats/points/cloud_reader.h"

namespace landfall {

/// CloudInfo::time_base of a file whose first time is this.
[[nodiscard]] inline std::int64_t time_base(std::int64_t first) {
  constexpr std::int64_t kExact = std::int64_t{1} << 53U;
  return first > kExact || first < -kExact ? first : 0;
}

/// time - base, exact where it is below 2^53.
[[nodiscard]] inline double time_from(std::int64_t base, std::int64_t time) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(time, base, &difference))
    return static_cast<double>(time) - static_cast<double>(base);
  return static_cast<double>(difference);
}

/// CloudInfo::is_float32 of columns whose types are these.
template <class TypeOf>
[[nodiscard]] std::array<bool, 3> float32_axes(const CloudColumns& columns, const TypeOf& type_of) {
  return {type_of(*columns[0]) == NumberType::float32, type_of(*columns[1]) == NumberType::float32,
          type_of(*columns[2]) == NumberType::float32};
}

// One function per format; open_cloud() chooses it.

[[nodiscard]] std::unique_ptr<CloudReader> open_las(std::unique_ptr<CloudBytes> file);
[[nodiscard]] std::unique_ptr<CloudReader> open_ply_cloud(std::unique_ptr<CloudBytes> file,
                                                          const ColumnChoice& choice);
[[nodiscard]] std::unique_ptr<CloudReader> open_pcd(std::unique_ptr<CloudBytes> file,
                                                    const ColumnChoice& choice);
[[nodiscard]] std::unique_ptr<CloudReader> open_ptx(std::unique_ptr<CloudBytes> file);
[[nodiscard]] std::unique_ptr<CloudReader> open_qfit(std::unique_ptr<CloudBytes> file);
/// Text with a header line or none.
[[nodiscard]] std::unique_ptr<CloudReader> open_text_cloud(std::unique_ptr<CloudBytes> file,
                                                           const ColumnChoice& choice);

/// True where a file begins as QFIT: the length of its records, then records of its header.
[[nodiscard]] bool is_qfit(const CloudBytes& file);

}  // namespace landfall
