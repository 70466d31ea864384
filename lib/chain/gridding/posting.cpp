// SPDX-License-Identifier: GPL-3.0-or-later
// A point's cell is found once. The edges of the bins of 1, 2, 5, 10, ... times a posting, whose centres are
// multiples of it, are edges of cells of half that posting (of 2, 5, 10, ...: of a quarter), so that a bin is
// a whole number of cells.
#include "chain/gridding/posting.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "base/numerics/rounding.h"
#include "chain/gridding/convex_hull.h"

namespace landfall {
namespace {

constexpr double kEdge_bins = 1e-9;  // a bin centre on the hull lies within it
constexpr double kMaxCells = 0x1p32;
constexpr double kMaxIndex = 0x1p36;
constexpr std::int64_t kOrigin = std::int64_t{1} << 31U;  // of a tile's row and column in its key

/// Bins of the rows of a hull whose centres lie in it.
class HullRows {
 public:
  HullRows(const std::vector<Horizontal>& hull, double resolution_m) {
    const auto [low, high] = std::ranges::minmax(hull, {}, &Horizontal::y);
    first_ = static_cast<std::int64_t>(std::ceil(low.y / resolution_m - kEdge_bins));
    const auto last = static_cast<std::int64_t>(std::floor(high.y / resolution_m + kEdge_bins));
    for (std::int64_t row = first_; row <= last; ++row)
      rows_.push_back(
          row_of(hull, std::clamp(static_cast<double>(row) * resolution_m, low.y, high.y), resolution_m));
  }

  [[nodiscard]] std::int64_t count() const {
    std::int64_t count = 0;
    for (const auto& [first, last] : rows_) count += std::max<std::int64_t>(0, last - first + 1);
    return count;
  }
  [[nodiscard]] bool contains(BinIndex bin) const {
    const std::int64_t row = bin.row - first_;
    if (row < 0 || row >= std::ssize(rows_)) return false;
    const auto& [first, last] = rows_[static_cast<std::size_t>(row)];
    return first <= bin.col && bin.col <= last;
  }

 private:
  static std::pair<std::int64_t, std::int64_t> row_of(const std::vector<Horizontal>& hull, double y,
                                                      double resolution_m) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Horizontal& a = hull[i];
      const Horizontal& b = hull[(i + 1) % hull.size()];
      if (y < std::min(a.y, b.y) || y > std::max(a.y, b.y)) continue;
      auto [west, east] = std::minmax({a.x, b.x});
      if (a.y != b.y) west = east = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
      low = std::min(low, west);
      high = std::max(high, east);
    }
    return {static_cast<std::int64_t>(std::ceil(low / resolution_m - kEdge_bins)),
            static_cast<std::int64_t>(std::floor(high / resolution_m + kEdge_bins))};
  }

  std::int64_t first_ = 0;
  std::vector<std::pair<std::int64_t, std::int64_t>> rows_;
};

}  // namespace

void PointOutline::add(std::span<const double> x_m, std::span<const double> y_m) {
  std::vector<Horizontal> points = hull_;
  for (std::size_t i = 0; i < x_m.size(); ++i) points.push_back({x_m[i], y_m[i]});
  count_ += std::ssize(x_m);
  hull_ = convex_hull(points);
}

double PointOutline::area_m2() const {
  double twice = 0;
  for (std::size_t i = 0; i < hull_.size(); ++i) {
    const Horizontal& a = hull_[i];
    const Horizontal& b = hull_[(i + 1) % hull_.size()];
    twice += (a.x - hull_[0].x) * (b.y - hull_[0].y) - (b.x - hull_[0].x) * (a.y - hull_[0].y);
  }
  return twice / 2;
}

double PointOutline::extent_m() const {
  if (hull_.empty()) return 0;
  const auto [west, east] = std::ranges::minmax(hull_, {}, &Horizontal::x);
  const auto [south, north] = std::ranges::minmax(hull_, {}, &Horizontal::y);
  return std::max(east.x - west.x, north.y - south.y);
}

Horizontal PointOutline::reach_m() const {
  Horizontal reach;
  for (const Horizontal& corner : hull_)
    reach = {std::max(reach.x, std::abs(corner.x)), std::max(reach.y, std::abs(corner.y))};
  return reach;
}

void CellSet::insert(BinIndex cell) {
  const auto key = static_cast<std::uint64_t>((cell.row >> 6U) + kOrigin) << 32U |
                   static_cast<std::uint64_t>((cell.col >> 6U) + kOrigin);
  if (last_ == nullptr || key != last_key_) {
    last_ = &tiles_[key];
    last_key_ = key;
  }
  (*last_)[static_cast<std::size_t>(cell.row & 63)] |= std::uint64_t{1}
                                                       << static_cast<unsigned>(cell.col & 63);
}

void CellSet::for_each(const std::function<void(BinIndex)>& use) const {
  for (const auto& [key, tile] : tiles_) {
    const std::int64_t row = (static_cast<std::int64_t>(key >> 32U) - kOrigin) * 64;
    const std::int64_t col = (static_cast<std::int64_t>(key & 0xffffffffU) - kOrigin) * 64;
    for (std::int64_t i = 0; i < 64; ++i)
      for (std::uint64_t bits = tile[static_cast<std::size_t>(i)]; bits != 0; bits &= bits - 1)
        use({row + i, col + std::countr_zero(bits)});
  }
}

double Posting::metres() const {
  double power = 1;  // exact up to 10^22
  for (int i = 0; i < std::abs(exponent); ++i) power *= 10;
  return exponent < 0 ? digit / power : digit * power;
}

Posting Posting::next() const {
  return digit == 1 ? Posting{2, exponent} : digit == 2 ? Posting{5, exponent} : Posting{1, exponent + 1};
}

Posting Posting::at_most(double limit_m) {
  Posting posting{1, 0};
  while (posting.metres() > limit_m) --posting.exponent;
  while (posting.next().metres() <= limit_m) posting = posting.next();
  return posting;
}

PostingSearch::PostingSearch(PointOutline outline) : outline_(std::move(outline)) {
  // n points fill at most n bins, of an area or, where they lie on a line, of a length.
  const auto maximum = static_cast<double>(outline_.count()) / (1 - kMaxEmptyShare);
  const double area_m2 = outline_.area_m2();
  const double bound_m = std::max(std::sqrt(area_m2 / maximum), outline_.extent_m() / maximum);
  first_ = Posting::at_most(bound_m * 0.9);  // the hull's border has bins of its own
  const auto cell = [](const Posting& posting) { return posting.metres() / (posting.digit == 2 ? 4 : 2); };
  const Horizontal reach = outline_.reach_m();
  while (area_m2 / (cell(first_) * cell(first_)) > kMaxCells ||
         std::max(reach.x, reach.y) / cell(first_) > kMaxIndex)
    first_ = first_.next();
  cell_m_ = cell(first_);
}

void PostingSearch::mark(std::span<const double> x_m, std::span<const double> y_m) {
  for (std::size_t i = 0; i < x_m.size(); ++i)
    cells_.insert({static_cast<std::int64_t>(std::floor(y_m[i] / cell_m_)),
                   static_cast<std::int64_t>(std::floor(x_m[i] / cell_m_))});
}

HullBins count_hull_bins(const std::vector<Horizontal>& hull, double resolution_m, const CellSet& filled) {
  const HullRows rows(hull, resolution_m);
  HullBins bins{rows.count(), rows.count()};
  filled.for_each([&](BinIndex bin) { bins.empty -= rows.contains(bin) ? 1 : 0; });
  return bins;
}

HullBins PostingSearch::bins(const Posting& posting) const {
  const std::int64_t width = std::llround(posting.metres() / cell_m_);
  CellSet filled;
  cells_.for_each([&](BinIndex cell) {
    filled.insert({floor_div(cell.row + width / 2, width), floor_div(cell.col + width / 2, width)});
  });
  return count_hull_bins(outline_.hull(), posting.metres(), filled);
}

std::optional<ChosenPosting> PostingSearch::finest(const std::function<bool(double)>& is_allowed) const {
  for (Posting posting = first_; posting.metres() <= 4 * outline_.extent_m(); posting = posting.next()) {
    if (!is_allowed(posting.metres())) continue;
    const HullBins counted = bins(posting);
    if (static_cast<double>(counted.empty) <= kMaxEmptyShare * static_cast<double>(counted.inside))
      return ChosenPosting{posting, counted};
  }
  return std::nullopt;
}

}  // namespace landfall
