// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D13, D470
#include "base/numerics/random.h"

#include <algorithm>

#include "base/numerics/box_muller.h"

namespace landfall {

double RandomField::normal(std::uint64_t i, std::uint64_t j) const {
  double value = 0;
  normals(i, j, {&value, 1});
  return value;
}

void RandomField::normals(std::uint64_t i, std::uint64_t first_j, std::span<double> out) const {
  normals({i, first_j}, {0, 1}, out);
}

void RandomField::normals_along_i(std::uint64_t first_i, std::uint64_t j, std::span<double> out) const {
  normals({first_i, j}, {1, 0}, out);
}

void RandomField::normals(Counter first, Counter step, std::span<double> out) const {
  constexpr std::size_t kBlock = 256;  // fits in the L1 cache
  std::array<double, kBlock> u;
  std::array<double, kBlock> v;
  for (std::size_t begin = 0; begin < out.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, out.size() - begin);
    for (std::size_t k = 0; k < count; ++k) {
      const auto words = block(first.i + step.i * (begin + k), first.j + step.j * (begin + k));
      u[k] = unit(words[0]);
      v[k] = unit(words[1]);
    }
    box_muller(std::span(u).first(count), std::span(v).first(count), out.subspan(begin, count));
  }
}

}  // namespace landfall
