// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D13, D470
#include "base/numerics/random.h"

#include <algorithm>
#include <array>

#include "base/numerics/box_muller.h"

namespace landfall {
namespace {

constexpr std::size_t kPiece = 256;  // fits in the L1 cache
using Piece = std::array<double, kPiece>;

/// Calls use(begin, count) for the pieces of `size` draws.
void for_each_piece(std::size_t size, const auto& use) {
  for (std::size_t begin = 0; begin < size; begin += kPiece) use(begin, std::min(kPiece, size - begin));
}

/// Box-Muller of the uniforms that fill(begin, u, v) makes for the draws from `begin` on.
void fill_normals(std::span<double> out, const auto& fill) {
  Piece u;
  Piece v;
  for_each_piece(out.size(), [&](std::size_t begin, std::size_t count) {
    const std::span<double> u_piece = std::span(u).first(count);
    const std::span<double> v_piece = std::span(v).first(count);
    fill(begin, u_piece, v_piece);
    box_muller(u_piece, v_piece, out.subspan(begin, count));
  });
}

}  // namespace

void RandomField::find_less(std::uint64_t i, std::uint64_t first_j, double limit,
                            std::span<std::int8_t> out) const {
  Piece u;
  for_each_piece(out.size(), [&](std::size_t begin, std::size_t count) {
    philox_uniforms({key_, i, first_j + begin, draw_}, std::span(u).first(count), {});
    for (std::size_t k = 0; k < count; ++k) out[begin + k] = u[k] < limit ? 1 : 0;
  });
}

double RandomField::normal(std::uint64_t i, std::uint64_t j) const {
  double value = 0;
  normals(i, j, {&value, 1});
  return value;
}

void RandomField::normals(std::uint64_t i, std::uint64_t first_j, std::span<double> out) const {
  fill_normals(out, [&](std::size_t begin, std::span<double> u, std::span<double> v) {
    philox_uniforms({key_, i, first_j + begin, draw_}, u, v);
  });
}

void RandomField::normals_along_i(std::uint64_t first_i, std::uint64_t j, std::span<double> out) const {
  fill_normals(out, [&](std::size_t begin, std::span<double> u, std::span<double> v) {
    for (std::size_t k = 0; k < u.size(); ++k) {
      const auto words = philox_block(key_, first_i + begin + k, j, draw_);
      u[k] = uniform_of(words[0]);
      v[k] = uniform_of(words[1]);
    }
  });
}

}  // namespace landfall
