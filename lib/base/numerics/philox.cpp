// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/numerics/philox.h"

#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/numerics/philox.cpp"
#include "base/numerics/elementary-inl.h"

namespace landfall {

/// philox_uniforms() of the blocks from `begin` on, one by one.
void single_uniforms(const PhiloxRow& row, std::size_t begin, std::span<double> first,
                     std::span<double> second);

}  // namespace landfall

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

#if HWY_TARGET <= HWY_AVX3

using U = hn::Vec<Bits>;
using Words32 = hn::Repartition<std::uint32_t, Bits>;

HWY_INLINE U BitsOf(std::uint64_t word) { return hn::Set(Bits(), word); }

/// A factor and its halves.
struct PhiloxFactor {
  U all, high, low;
  HWY_INLINE explicit PhiloxFactor(std::uint64_t value)
      : all(BitsOf(value)), high(BitsOf(value >> 32U)), low(BitsOf(value & 0xffffffffU)) {}
};

/// The product of the lower halves of the lanes.
HWY_INLINE U MulLower(U a, U b) { return hn::MulEven(hn::BitCast(Words32(), a), hn::BitCast(Words32(), b)); }

/// The upper half of the 128 bits of a b.
HWY_INLINE U MulUpperHalf(U a, const PhiloxFactor& b) {
  const U a_high = hn::ShiftRight<32>(a);
  const U middle = hn::Add(MulLower(a_high, b.low), hn::ShiftRight<32>(MulLower(a, b.low)));
  const U other = hn::Add(MulLower(a, b.high), hn::And(middle, BitsOf(0xffffffffU)));
  return hn::Add(hn::Add(MulLower(a_high, b.high), hn::ShiftRight<32>(middle)), hn::ShiftRight<32>(other));
}

struct PhiloxBlock {
  U w0, w1, w2, w3;
};

HWY_INLINE PhiloxBlock PhiloxRound(const PhiloxBlock& b, const PhiloxFactor& m0, const PhiloxFactor& m1,
                                   U key0, U key1) {
  return {hn::Xor3(MulUpperHalf(b.w2, m1), b.w1, key0), hn::Mul(b.w2, m1.all),
          hn::Xor3(MulUpperHalf(b.w0, m0), b.w3, key1), hn::Mul(b.w0, m0.all)};
}

HWY_INLINE V UniformOf(U word) {
  return hn::Mul(hn::ConvertTo(D(), hn::BitCast(hn::RebindToSigned<D>(), hn::ShiftRight<11>(word))),
                 constant(0x1p-53));
}

void Uniforms(const PhiloxRow& row, std::span<double> first, std::span<double> second) {
  constexpr int kRounds = 10;
  constexpr std::size_t kPair = 2 * kMaxLanes;  // two vectors at a time, for a round waits for the one before
  static_assert(hn::MaxLanes(D()) == kMaxLanes);
  const PhiloxFactor m0(PHILOX_M4x64_0);
  const PhiloxFactor m1(PHILOX_M4x64_1);
  // The first round XORs j with a word that it makes of the others.
  const auto begin = r123::Philox4x64_R<1>()({{row.i, 0, row.draw, 0}}, row.key);
  const PhiloxBlock start{BitsOf(begin[0]), BitsOf(begin[1]), BitsOf(begin[2]), BitsOf(begin[3])};
  const std::size_t whole = first.size() / kPair * kPair;
  for (std::size_t k = 0; k < whole; k += kPair) {
    const U j = hn::Add(BitsOf(row.first_j + k), hn::Iota(Bits(), 0));
    PhiloxBlock a = start;
    PhiloxBlock b = start;
    a.w0 = hn::Xor(a.w0, j);
    b.w0 = hn::Xor(b.w0, hn::Add(j, BitsOf(kMaxLanes)));
    std::uint64_t key0 = row.key[0];
    std::uint64_t key1 = row.key[1];
    for (int round = 1; round < kRounds; ++round) {
      key0 += PHILOX_W64_0;
      key1 += PHILOX_W64_1;
      a = PhiloxRound(a, m0, m1, BitsOf(key0), BitsOf(key1));
      b = PhiloxRound(b, m0, m1, BitsOf(key0), BitsOf(key1));
    }
    hn::StoreU(UniformOf(a.w0), D(), first.data() + k);
    hn::StoreU(UniformOf(b.w0), D(), first.data() + k + kMaxLanes);
    if (second.empty()) continue;
    hn::StoreU(UniformOf(a.w1), D(), second.data() + k);
    hn::StoreU(UniformOf(b.w1), D(), second.data() + k + kMaxLanes);
  }
  single_uniforms(row, whole, first, second);
}

#else

void Uniforms(const PhiloxRow& row, std::span<double> first, std::span<double> second) {
  single_uniforms(row, 0, first, second);
}

#endif

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(Uniforms);

void single_uniforms(const PhiloxRow& row, std::size_t begin, std::span<double> first,
                     std::span<double> second) {
  for (std::size_t k = begin; k < first.size(); ++k) {
    const auto words = philox_block(row.key, row.i, row.first_j + k, row.draw);
    first[k] = uniform_of(words[0]);
    if (!second.empty()) second[k] = uniform_of(words[1]);
  }
}

void philox_uniforms(const PhiloxRow& row, std::span<double> first, std::span<double> second) {
  assert(second.empty() || second.size() == first.size());
  HWY_DYNAMIC_DISPATCH(Uniforms)(row, first, second);
}

}  // namespace landfall
#endif
