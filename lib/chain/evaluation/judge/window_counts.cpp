// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/judge/window_counts.h"

#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/evaluation/judge/window_counts.cpp"
#include "base/numerics/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

class DeviationCounter {
 public:
  DeviationCounter(const MeanRange& means, double limit) : means_(means), limit_(limit) {}

  template <class Tag>
  HWY_INLINE void add(Tag d, const double* errors, std::uint64_t* packed) {
    const hn::RebindToUnsigned<Tag> counts;
    const auto e = hn::LoadU(d, errors);
    const auto lowest = hn::Set(d, means_.lowest);
    const auto highest = hn::Set(d, means_.highest);
    const auto limit = hn::Set(d, limit_);
    const auto possible = hn::Or(hn::Gt(hn::Sub(e, lowest), limit), hn::Gt(hn::Sub(highest, e), limit));
    const auto certain = hn::Or(hn::Gt(hn::Sub(e, highest), limit), hn::Gt(hn::Sub(lowest, e), limit));
    const auto bit = [&](auto mask, unsigned field) {
      return hn::And(hn::BitCast(counts, hn::VecFromMask(d, mask)),
                     hn::Set(counts, std::uint64_t{1} << (field * PackedCounts::kBits)));
    };
    hn::StoreU(hn::Or(bit(hn::Eq(e, e), 0), hn::Or(bit(possible, 1), bit(certain, 2))), counts, packed);
    possible_ += hn::CountTrue(d, possible);
    certain_ += hn::CountTrue(d, certain);
  }

  [[nodiscard]] DeviationTotals totals() const {
    return {static_cast<std::int64_t>(possible_), static_cast<std::int64_t>(certain_)};
  }

 private:
  MeanRange means_;
  double limit_;
  std::size_t possible_ = 0;
  std::size_t certain_ = 0;
};

DeviationTotals CountDeviations(const View<const double>& errors, const MeanRange& means, double limit,
                                const View<std::uint64_t>& packed) {
  DeviationCounter counter(means, limit);
  const auto cols = static_cast<std::size_t>(errors.cols);
  const std::size_t whole = cols / hn::Lanes(D()) * hn::Lanes(D());
  for (std::int64_t row = 0; row < errors.rows; ++row) {
    const double* const in = errors.row(row);
    std::uint64_t* const out = packed.row(row);
    for (std::size_t c = 0; c < whole; c += hn::Lanes(D())) counter.add(D(), in + c, out + c);
    for (std::size_t c = whole; c < cols; ++c) counter.add(hn::CappedTag<double, 1>(), in + c, out + c);
  }
  return counter.totals();
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(CountDeviations);

DeviationTotals count_deviations(const View<const double>& errors, const MeanRange& means, double limit,
                                 const View<std::uint64_t>& packed) {
  return HWY_DYNAMIC_DISPATCH(CountDeviations)(errors, means, limit, packed);
}

}  // namespace landfall
#endif
