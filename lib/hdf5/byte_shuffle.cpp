// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5/byte_shuffle.h"

#include <array>
#include <cassert>
#include <cstring>
#include <utility>

namespace landfall {
namespace {

// The vector extension of g++ and clang: 16 bytes in a register if the processor has such registers.
using Bytes16 = unsigned char __attribute__((vector_size(16)));
template <std::size_t N>
using Block = std::array<Bytes16, N>;

constexpr std::size_t kBlockElements = sizeof(Bytes16);

Bytes16 interleave_lower(Bytes16 a, Bytes16 b) {
  return __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
}

Bytes16 interleave_upper(Bytes16 a, Bytes16 b) {
  return __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
}

/// Moves the byte at address a of the block to the address whose binary digits are a's, rotated left by one.
template <std::size_t N>
Block<N> rotated(const Block<N>& in) {
  Block<N> out;
  for (std::size_t i = 0; i < N / 2; ++i) {
    out[2 * i] = interleave_lower(in[i], in[i + N / 2]);
    out[2 * i + 1] = interleave_upper(in[i], in[i + N / 2]);
  }
  return out;
}

/// A block holds 16 elements of N bytes. An address consists of the digits of the element number and those of
/// the byte number. Swapping the two is a rotation: by the 4 digits of the element number, or back by the
/// digits of the byte number.
template <std::size_t N, std::size_t... Step>
Block<N> rotated_by(Block<N> block, std::index_sequence<Step...> /*steps*/) {
  ((static_cast<void>(Step), block = rotated(block)), ...);
  return block;
}

constexpr std::size_t byte_digits(std::size_t element_size) { return element_size == 8 ? 3 : 2; }

void shuffle_one_by_one(std::span<const std::byte> elements, std::size_t element_size, std::size_t begin,
                        std::span<std::byte> planes) {
  const std::size_t count = elements.size() / element_size;
  for (std::size_t byte = 0; byte < element_size; ++byte)
    for (std::size_t i = begin; i < count; ++i) planes[byte * count + i] = elements[i * element_size + byte];
}

void unshuffle_one_by_one(std::span<const std::byte> planes, std::size_t element_size, std::size_t first,
                          std::size_t begin, std::span<std::byte> elements) {
  const std::size_t plane = planes.size() / element_size;
  for (std::size_t byte = 0; byte < element_size; ++byte)
    for (std::size_t i = begin; i < elements.size() / element_size; ++i)
      elements[i * element_size + byte] = planes[byte * plane + first + i];
}

/// Handles whole blocks; returns the number of elements in them.
template <std::size_t N>
std::size_t shuffle_blocks(std::span<const std::byte> elements, std::span<std::byte> planes) {
  const std::size_t count = elements.size() / N;
  std::size_t i = 0;
  for (; i + kBlockElements <= count; i += kBlockElements) {
    Block<N> block;
    std::memcpy(block.data(), elements.data() + i * N, sizeof block);
    block = rotated_by(block, std::make_index_sequence<4>{});
    for (std::size_t byte = 0; byte < N; ++byte)
      std::memcpy(planes.data() + byte * count + i, &block[byte], sizeof(Bytes16));
  }
  return i;
}

template <std::size_t N>
std::size_t unshuffle_blocks(std::span<const std::byte> planes, std::size_t first,
                             std::span<std::byte> elements) {
  const std::size_t plane = planes.size() / N;
  std::size_t i = 0;
  for (; i + kBlockElements <= elements.size() / N; i += kBlockElements) {
    Block<N> block;
    for (std::size_t byte = 0; byte < N; ++byte)
      std::memcpy(&block[byte], planes.data() + byte * plane + first + i, sizeof(Bytes16));
    block = rotated_by(block, std::make_index_sequence<byte_digits(N)>{});
    std::memcpy(elements.data() + i * N, block.data(), sizeof block);
  }
  return i;
}

}  // namespace

void shuffle_bytes(std::span<const std::byte> elements, std::size_t element_size,
                   std::span<std::byte> planes) {
  assert(elements.size() == planes.size() && elements.size() % element_size == 0);
  std::size_t done = 0;
  if (element_size == 8) done = shuffle_blocks<8>(elements, planes);
  if (element_size == 4) done = shuffle_blocks<4>(elements, planes);
  shuffle_one_by_one(elements, element_size, done, planes);
}

void unshuffle_bytes(std::span<const std::byte> planes, std::size_t element_size, std::size_t first,
                     std::span<std::byte> elements) {
  assert(first * element_size + elements.size() <= planes.size() && elements.size() % element_size == 0);
  std::size_t done = 0;
  if (element_size == 8) done = unshuffle_blocks<8>(planes, first, elements);
  if (element_size == 4) done = unshuffle_blocks<4>(planes, first, elements);
  unshuffle_one_by_one(planes, element_size, first, done, elements);
}

}  // namespace landfall
