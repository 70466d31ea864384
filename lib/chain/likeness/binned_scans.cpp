// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D455, D456
#include "chain/likeness/binned_scans.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "chain/evaluation/quantile/quantile.h"

namespace landfall {
namespace {

constexpr std::uint32_t kNoBin = std::numeric_limits<std::uint32_t>::max();
constexpr double kNmad = 1.4826;

std::uint64_t lattice_key(const BinIndex& bin) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(bin.row)) << 32U) |
         static_cast<std::uint32_t>(bin.col);
}

/// The share of the scan's duration at each of its returns; 0 without times.
class DurationShare {
 public:
  explicit DurationShare(const ComparedScan& scan) : t_(scan.t) {}
  [[nodiscard]] double operator()(std::size_t i) const {
    const double duration = t_.empty() ? 0 : t_.back() - t_.front();
    return duration > 0 ? (t_[i] - t_.front()) / duration : 0;
  }

 private:
  const std::vector<double>& t_;
};

/// Weighted second moments of mean positions about those of a bin.
struct Scatter {
  double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;

  void add(const ReturnSum& centre, const ReturnSum& other) {
    if (centre.count == 0 || other.count == 0) return;
    const double x = other.x / other.count - centre.x / centre.count;
    const double y = other.y / other.count - centre.y / centre.count;
    const double z = other.z / other.count - centre.z / centre.count;
    xx += other.count * x * x;
    xy += other.count * x * y;
    yy += other.count * y * y;
    xz += other.count * x * z;
    yz += other.count * y * z;
  }
};

/// The gradient along the directions in which positions scatter.
Gradient gradient_of(const Scatter& s) {
  constexpr double kThin = 0.01;  // of the larger moment
  Eigen::Matrix2d moments;
  moments << s.xx, s.xy, s.xy, s.yy;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(moments);
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  for (int k = 0; k < 2; ++k) {
    if (!(axes.eigenvalues()[k] > kThin * axes.eigenvalues()[1])) continue;
    const Eigen::Vector2d axis = axes.eigenvectors().col(k);
    gradient += axis * axis.dot(Eigen::Vector2d(s.xz, s.yz)) / axes.eigenvalues()[k];
  }
  return {gradient.x(), gradient.y()};
}

struct BinDifference {
  std::size_t bin = 0;
  double d = 0;
};

/// d in the bins of side 0 that the mean positions of side 1, moved back by `shift`, lie in.
std::vector<BinDifference> differences(const BinnedScans& scans, const std::vector<Gradient>& gradients,
                                       const ReturnSums& sums, const Horizontal& shift) {
  std::vector<BinDifference> result;
  for (std::size_t i = 0; i < gradients.size(); ++i) {
    const ReturnSum& b = sums[1][i];
    if (b.count == 0) continue;
    const double x = b.x / b.count - shift.x, y = b.y / b.count - shift.y;
    const auto bin = shift == Horizontal{} ? std::optional(i) : scans.number_at(x, y);
    if (!bin || sums[0][*bin].count == 0 || std::isnan(gradients[*bin].x)) continue;
    const ReturnSum& a = sums[0][*bin];
    result.push_back({*bin, b.z / b.count - a.z / a.count - gradients[*bin].x * (x - a.x / a.count) -
                                gradients[*bin].y * (y - a.y / a.count)});
  }
  return result;
}

struct MedianAndNmad {
  double median = 0, nmad = 0;
  explicit MedianAndNmad(const std::vector<BinDifference>& differences) {
    std::vector<double> values;
    for (const BinDifference& each : differences) values.push_back(each.d);
    median = quantile_in_place(values, 0.5);
    for (double& value : values) value = std::abs(value - median);
    nmad = kNmad * quantile_in_place(values, 0.5);
  }
};

/// Least squares by normal equations of the columns 1, x, y, -g_x, -g_y, each scaled to one length.
class ShiftAndTilt {
 public:
  using Row = Eigen::Matrix<double, 5, 1>;
  void add(const Row& row, double d) {
    normal_ += row * row.transpose();
    right_ += d * row;
  }
  /// As if `shift`, to which the solution's is added, were known to be 0.
  void damp_shift(double weight, const Horizontal& shift) {
    normal_.diagonal().tail<2>().array() += weight;
    right_.tail<2>() -= weight * Eigen::Vector2d(shift.x, shift.y);
  }
  [[nodiscard]] Row solution() const {
    const Row scale = normal_.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 1.0; });
    const Eigen::Matrix<double, 5, 5> scaled = scale.asDiagonal() * normal_ * scale.asDiagonal();
    Eigen::JacobiSVD<Eigen::Matrix<double, 5, 5>, Eigen::NoQRPreconditioner> solver(
        scaled, Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (solver.info() != Eigen::Success) return Row::Constant(std::numeric_limits<double>::quiet_NaN());
    solver.setThreshold(1e-10);
    return scale.asDiagonal() * Row(solver.solve(scale.asDiagonal() * right_));
  }

 private:
  Eigen::Matrix<double, 5, 5> normal_ = Eigen::Matrix<double, 5, 5>::Zero();
  Row right_ = Row::Zero();
};

}  // namespace

void ReturnSum::add(const ReturnSum& other) {
  count += other.count;
  x += other.x;
  y += other.y;
  z += other.z;
  first = std::min(first, other.first);
}

BinnedScans::BinnedScans(const ComparedScan& a, const ComparedScan& b, double posting_m)
    : lattice_{.resolution_m = posting_m} {
  add(a, 0);
  add(b, 1);
}

std::optional<std::size_t> BinnedScans::number_at(double x, double y) const {
  const std::uint32_t* const found = find(lattice_.bin_of(x, y));
  return found == nullptr ? std::nullopt : std::optional<std::size_t>(*found);
}

const std::uint32_t* BinnedScans::find(const BinIndex& bin) const {
  const auto found = numbers_.find(lattice_key(bin));
  return found == numbers_.end() ? nullptr : &found->second;
}

std::uint32_t BinnedScans::number_of(const BinIndex& bin) {
  const auto [entry, is_new] = numbers_.emplace(lattice_key(bin), static_cast<std::uint32_t>(bins_.size()));
  if (is_new) bins_.push_back(bin);
  return entry->second;
}

void BinnedScans::add(const ComparedScan& scan, std::size_t which) {
  const DurationShare share(scan);
  std::vector<std::size_t> last_entry;  // of each bin
  for (std::size_t i = 0; i < scan.x.size(); ++i) {
    const std::uint32_t bin = number_of(lattice_.bin_of(scan.x[i], scan.y[i]));
    const BlockOfScan block = block_of(i, scan.x.size(), which);
    bin_of_return_.at(which).push_back(bin);
    if (last_entry.size() <= bin) last_entry.resize(bins_.size(), kNoBin);
    if (last_entry[bin] == kNoBin || entries_[last_entry[bin]].block != block) {
      last_entry[bin] = entries_.size();
      entries_.push_back({bin, block, {}});
    }
    entries_[last_entry[bin]].sum.add({1, scan.x[i], scan.y[i], scan.z[i], share(i)});
  }
}

ReturnSums BinnedScans::sums(const Sides& sides) const {
  ReturnSums result{std::vector<ReturnSum>(bins_.size()), std::vector<ReturnSum>(bins_.size())};
  for (const Entry& entry : entries_) result.at(sides.at(entry.block)).at(entry.bin).add(entry.sum);
  return result;
}

double BinnedScans::block_overlap() const {
  std::array<std::vector<std::uint32_t>, kBlocksOfScans> covered;
  for (const Entry& entry : entries_) covered.at(entry.block).push_back(entry.bin);
  double both = 0, smaller = 0;
  for (std::size_t b = 0; b < kBlocksOfScans; b += 2) {
    std::vector<std::uint32_t> common;
    std::ranges::sort(covered.at(b));
    std::ranges::sort(covered.at(b + 1));
    std::ranges::set_intersection(covered.at(b), covered.at(b + 1), std::back_inserter(common));
    both += static_cast<double>(common.size());
    smaller += static_cast<double>(std::min(covered.at(b).size(), covered.at(b + 1).size()));
  }
  return both / smaller;
}

Gradient BinnedScans::gradient_at(std::uint32_t bin, const ReturnSums& sums) const {
  Scatter scatter;
  for (std::int64_t row = -1; row <= 1; ++row)
    for (std::int64_t col = -1; col <= 1; ++col) {
      const std::uint32_t* const found = find({bins_[bin].row + row, bins_[bin].col + col});
      if (found == nullptr || *found == bin) continue;
      for (const std::vector<ReturnSum>& side : sums) scatter.add(side[bin], side[*found]);
    }
  return scatter.xx + scatter.yy > 0 ? gradient_of(scatter) : Gradient{};
}

std::vector<Gradient> BinnedScans::gradients() const {
  const ReturnSums both = sums(original_sides());
  std::vector<Gradient> result;
  for (std::uint32_t bin = 0; bin < bins_.size(); ++bin) result.push_back(gradient_at(bin, both));
  return result;
}

std::array<double, 10> covered_over_time(const std::vector<ReturnSum>& sums) {
  std::array<double, 10> covered{};
  double total = 0;
  for (const ReturnSum& sum : sums) {
    if (sum.count == 0) continue;
    ++total;
    for (std::size_t k = 0; k < covered.size(); ++k)
      covered.at(k) += sum.first * static_cast<double>(covered.size()) <= static_cast<double>(k + 1) ? 1 : 0;
  }
  for (double& value : covered) value /= total;
  return covered;
}

CoverageDifference coverage_difference(const ReturnSums& sums) {
  const std::size_t bins = sums[0].size();
  std::vector<BlockValue> counts;
  Eigen::Array2d sum = Eigen::Array2d::Zero(), squares = sum;
  double product = 0, only_one = 0;
  for (std::size_t i = 0; i < bins; ++i) {
    const Eigen::Array2d both(sums[0][i].count, sums[1][i].count);
    counts.push_back({both[0], 0});
    counts.push_back({both[1], 1});
    sum += both;
    squares += both.square();
    product += both[0] * both[1];
    only_one += both[0] == 0 || both[1] == 0 ? 1 : 0;
  }
  const auto n = static_cast<double>(bins);
  const Eigen::Array2d variance = n * squares - sum.square();
  CoverageDifference result;
  result.counts_ks = TwoSamples(std::move(counts)).ks_distance(original_sides());
  result.decorrelation = 1 - (n * product - sum[0] * sum[1]) / std::sqrt(variance[0] * variance[1]);
  result.only_one = only_one / n;
  const auto a = covered_over_time(sums[0]), b = covered_over_time(sums[1]);
  for (std::size_t k = 0; k < a.size(); ++k)
    result.over_time = std::max(result.over_time, std::abs(a.at(k) - b.at(k)));
  return result;
}

namespace {

/// A step of Gauss and Newton from `shift`: the solution of least squares, whose shift is the change of it.
ShiftAndTilt::Row step_from(const BinnedScans& scans, const std::vector<Gradient>& gradients,
                            const std::vector<BinDifference>& differences, const MedianAndNmad& level,
                            const Horizontal& shift) {
  ShiftAndTilt fit;
  for (const auto& [bin, d] : differences) {
    if (std::abs(d - level.median) > 3 * level.nmad) continue;
    const BinIndex place = scans.bins()[bin];
    fit.add((ShiftAndTilt::Row() << 1, static_cast<double>(place.col - scans.bins()[0].col),
             static_cast<double>(place.row - scans.bins()[0].row), -gradients[bin].x, -gradients[bin].y)
                .finished(),
            d);
  }
  const double relative_noise = level.nmad / scans.posting_m();
  fit.damp_shift(relative_noise * relative_noise, shift);
  return fit.solution();
}

}  // namespace

SurfaceDifference surface_difference(const BinnedScans& scans, const std::vector<Gradient>& gradients,
                                     const ReturnSums& sums, int max_steps) {
  constexpr std::size_t kMinBins = 10;
  constexpr double kLastStep = 0.01;  // bins
  Horizontal shift;
  std::vector<BinDifference> found = differences(scans, gradients, sums, shift);
  SurfaceDifference result{.bins = found.size()};
  if (found.size() < kMinBins) return result;
  const MedianAndNmad level(found);
  result.median_m = level.median;
  result.nmad_m = level.nmad;
  std::vector<double> sizes;
  for (const BinDifference& each : found) sizes.push_back(std::abs(each.d));
  result.p95_m = quantile_in_place(sizes, 0.95);
  for (int step = 0; step < max_steps; ++step) {
    if (step > 0) found = differences(scans, gradients, sums, shift);
    if (found.size() < kMinBins) break;
    const ShiftAndTilt::Row solved =
        step_from(scans, gradients, found, step == 0 ? level : MedianAndNmad(found), shift);
    shift = {shift.x + solved[3], shift.y + solved[4]};
    result.tilt_x_rad = solved[1] / scans.posting_m();
    result.tilt_y_rad = solved[2] / scans.posting_m();
    if (solved.tail<2>().norm() < kLastStep * scans.posting_m()) break;
  }
  result.shift_x_m = shift.x;
  result.shift_y_m = shift.y;
  return result;
}

}  // namespace landfall
