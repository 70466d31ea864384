// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D342
#include "chain/lidar/receiver/echo_timing.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/numerics/elementary.h"

#ifndef LANDFALL_ECHO_TIMING_CPP_
#define LANDFALL_ECHO_TIMING_CPP_

namespace landfall {

using BlockValues = std::array<double, EchoRays::kBlock>;

struct BlockTimes {
  BlockValues at, height, edge;
};

/// A maximum below this many thresholds has the edge of its own curvature.
constexpr double kClearlyAbove = 1.000001;

}  // namespace landfall

#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/lidar/receiver/echo_timing.cpp"
#include "base/numerics/elementary-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// Ranges are in units of sigma, from the echo's mean.
constexpr double kConverged = 1e-6;  ///< of the last Newton step: the next would be its square
constexpr int kMaxSteps = 40;

/// Ray j of the echoes in lanes: position and signal, kBlock apart.
struct LaneEchoes {
  const double* x;
  const double* pe;
  std::size_t rays;
};

/// w and its first two derivatives.
struct LaneWaveform {
  V value, slope, curvature;
};

HWY_INLINE LaneWaveform WaveformAt(const LaneEchoes& echoes, V x) {
  V value = constant(0);
  V slope = constant(0);
  V curvature = constant(0);
  for (std::size_t j = 0; j < echoes.rays; ++j) {
    const V distance = hn::Sub(hn::LoadU(D(), echoes.x + j * EchoRays::kBlock), x);
    const V square = hn::Mul(distance, distance);
    const V term =
        hn::Mul(hn::LoadU(D(), echoes.pe + j * EchoRays::kBlock), Exp(hn::Mul(constant(-0.5), square)));
    value = hn::Add(value, term);
    slope = hn::Add(slope, hn::Mul(distance, term));
    curvature = hn::Add(curvature, hn::Mul(hn::Sub(square, constant(1)), term));
  }
  return {value, slope, curvature};
}

/// The maximum: its position and height, and the sigma of a Gaussian of the same curvature there.
struct LanePeak {
  V x, height, sigma;
};

HWY_INLINE LanePeak PeakOf(const LaneEchoes& echoes) {
  V x = constant(0);
  V height = constant(0);
  V sigma = constant(1);
  M open = hn::Eq(x, x);
  for (int step = 0; step < kMaxSteps && !hn::AllFalse(D(), open); ++step) {
    const LaneWaveform w = WaveformAt(echoes, x);
    const V move = hn::Neg(hn::Div(w.slope, w.curvature));
    // Newton's parabola gives the height at the end of a small step
    const V parabola =
        hn::Sub(w.value, hn::Div(hn::Mul(w.slope, w.slope), hn::Mul(constant(2), w.curvature)));
    height = hn::IfThenElse(open, parabola, height);
    sigma = hn::IfThenElse(open, hn::Sqrt(hn::Neg(hn::Div(parabola, w.curvature))), sigma);
    x = hn::IfThenElse(open, hn::Add(x, move), x);
    open = hn::And(open, hn::Gt(hn::Abs(move), constant(kConverged)));
  }
  return {x, height, sigma};
}

/// The time at which w rises through `level`, which must be below the maximum: Newton's method on log w,
/// which is concave.
HWY_INLINE V CrossingOf(const LaneEchoes& echoes, const LanePeak& peak, V level) {
  const V depth = hn::Sqrt(hn::Mul(constant(2), Log(hn::Div(peak.height, level))));
  V x = hn::Sub(peak.x, hn::Mul(peak.sigma, depth));
  M open = hn::Eq(x, x);
  for (int step = 0; step < kMaxSteps && !hn::AllFalse(D(), open); ++step) {
    const LaneWaveform w = WaveformAt(echoes, x);
    const V excess = Log(hn::Div(w.value, level));
    const V move = hn::Neg(hn::Div(hn::Mul(excess, w.value), w.slope));
    x = hn::IfThenElse(open, hn::Add(x, move), x);
    open = hn::And(open, hn::Gt(hn::Abs(move), constant(kConverged)));
  }
  return x;
}

/// Position, height and edge of the echoes of a block, in units of sigma.
void TimeBlock(const double* x, const double* pe, std::size_t rays, const EchoTiming& timing,
               BlockTimes& out) {
  for (std::size_t lane = 0; lane < EchoRays::kBlock; lane += hn::Lanes(D())) {
    const LaneEchoes echoes{x + lane, pe + lane, rays};
    const LanePeak peak = PeakOf(echoes);
    V at = peak.x;
    V edge = peak.sigma;
    if (timing.point == TimingPoint::constant_fraction)
      at = CrossingOf(echoes, peak, hn::Mul(constant(timing.fraction), peak.height));
    if (timing.point == TimingPoint::leading_edge) {
      const V level = constant(timing.threshold_pe);
      const M crosses = hn::Gt(peak.height, hn::Mul(constant(kClearlyAbove), level));
      const V crossed = hn::IfThenElse(crosses, level, hn::Mul(constant(0.5), peak.height));
      const V depth = hn::Sqrt(hn::Mul(constant(2), Log(hn::Div(peak.height, crossed))));
      const V from_peak = hn::Sub(peak.x, CrossingOf(echoes, peak, crossed));
      edge = hn::IfThenElse(crosses, hn::Div(from_peak, depth), edge);
    }
    hn::StoreU(at, D(), out.at.data() + lane);
    hn::StoreU(peak.height, D(), out.height.data() + lane);
    hn::StoreU(edge, D(), out.edge.data() + lane);
  }
}

/// The waveform of the rays x[j], pe[j] at kBlock positions.
void SampleWaveform(std::span<const double> x, std::span<const double> pe, const BlockValues& at,
                    BlockValues& value) {
  for (std::size_t lane = 0; lane < EchoRays::kBlock; lane += hn::Lanes(D())) {
    const V where = hn::LoadU(D(), at.data() + lane);
    V sum = constant(0);
    for (std::size_t j = 0; j < x.size(); ++j) {
      const V distance = hn::Sub(constant(x[j]), where);
      sum = hn::Add(sum, hn::Mul(constant(pe[j]), Exp(hn::Mul(constant(-0.5), hn::Mul(distance, distance)))));
    }
    hn::StoreU(sum, D(), value.data() + lane);
  }
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {
namespace {

HWY_EXPORT(TimeBlock);
HWY_EXPORT(SampleWaveform);

/// Longer echoes, in units of sigma, may have several maxima.
constexpr double kLongEcho = 1;
constexpr double kScanStep = 1.0 / 16;
/// A long echo may be flat or have two maxima above this fraction of its height, exp(-1/2): one sigma of a
/// Gaussian. The edge there bounds that of a higher level, which would extrapolate the flat part far ahead.
constexpr double kTopOfLongEcho = 0.6065306597126334;
constexpr double kLongestEdge = 1.5;
constexpr double kRootStep = 1e-10;  ///< ends the search for a root
constexpr int kMaxRootSteps = 60;    ///< bisections alone need 31

/// A long echo: rays x[j], pe[j], in units of sigma from the mean.
class LongEcho {
 public:
  LongEcho(std::vector<double> x, std::vector<double> pe) : x_(std::move(x)), pe_(std::move(pe)) {
    const auto [nearest, farthest] = std::ranges::minmax(x_);
    nearest_ = nearest;
    farthest_ = farthest;
    for (const double signal : pe_) signal_ += signal;
    find_peak();
  }

  [[nodiscard]] double peak() const { return peak_; }
  [[nodiscard]] double height() const { return height_; }
  /// The first crossing of a level below the maximum.
  [[nodiscard]] double crossing(double level) const {
    // each sub-ray lies beyond the nearest, so that w(x) <= N exp(-(nearest - x)^2/2)
    const double begin = nearest_ - std::sqrt(2 * natural_log(std::max(1.0, signal_ / level))) - kScanStep;
    double high = peak_;
    scan(begin, peak_, [&](double at, double value) {
      if (value < level) return true;
      high = at;
      return false;
    });
    const auto excess = [&](double at) -> Line {
      const Waveform w = waveform(at);
      return {w.value - level, w.slope};
    };
    return root(excess, std::max(begin, high - kScanStep), high);
  }

 private:
  /// w and its first two derivatives.
  struct Waveform {
    double value = 0, slope = 0, curvature = 0;
  };
  /// A function's value and derivative at one position.
  struct Line {
    double value, slope;
  };

  [[nodiscard]] Waveform waveform(double at) const {
    Waveform w;
    for (std::size_t j = 0; j < x_.size(); ++j) {
      const double distance = x_[j] - at;
      const double term = pe_[j] * exponential(-0.5 * distance * distance);
      w.value += term;
      w.slope += distance * term;
      w.curvature += (distance * distance - 1) * term;
    }
    return w;
  }

  /// The argument at which a function rises through zero between `low` and `high`: Newton's method, with a
  /// bisection where a step would leave the bracket.
  [[nodiscard]] static double root(const auto& function, double low, double high) {
    double at = (low + high) / 2;
    for (int step = 0; step < kMaxRootSteps; ++step) {
      const Line line = function(at);
      (line.value > 0 ? high : low) = at;
      double next = at - line.value / line.slope;
      if (!(next > low && next < high)) next = (low + high) / 2;
      const double move = std::abs(next - at);
      at = next;
      if (move < kRootStep) break;
    }
    return at;
  }

  /// Calls visit(position, value) from `begin` to `end` until it returns false.
  void scan(double begin, double end, const auto& visit) const {
    BlockValues at;
    BlockValues value;
    for (double first = begin; first <= end; first += kScanStep * EchoRays::kBlock) {
      for (std::size_t i = 0; i < at.size(); ++i) at[i] = first + kScanStep * static_cast<double>(i);
      HWY_DYNAMIC_DISPATCH(SampleWaveform)(x_, pe_, at, value);
      for (std::size_t i = 0; i < at.size(); ++i)
        if (at[i] > end || !visit(at[i], value[i])) return;
    }
  }

  void find_peak() {
    scan(nearest_, farthest_, [&](double at, double value) {
      if (value > height_) {
        height_ = value;
        peak_ = at;
      }
      return true;
    });
    const auto fall = [&](double at) -> Line {
      const Waveform w = waveform(at);
      return {-w.slope, -w.curvature};
    };
    peak_ = root(fall, peak_ - kScanStep, peak_ + kScanStep);
    height_ = waveform(peak_).value;
  }

  std::vector<double> x_, pe_;
  double nearest_ = 0, farthest_ = 0, signal_ = 0;
  double peak_ = 0, height_ = 0;
};

/// Sums over the rays of an echo; positions in units of sigma from the mean.
struct EchoSums {
  double signal_pe = 0, mean_m = 0, variance = 0, length = 0;
};

struct EchoTime {
  double at = 0, height = 0, edge = 0;
};

EchoTime time_long_echo(const LongEcho& echo, const EchoTiming& timing) {
  EchoTime time{echo.peak(), echo.height()};
  if (timing.point == TimingPoint::constant_fraction)
    time.at = echo.crossing(timing.fraction * echo.height());
  if (timing.point == TimingPoint::leading_edge) {
    const auto edge_at = [&](double level) {
      return (echo.peak() - echo.crossing(level)) / std::sqrt(2 * natural_log(echo.height() / level));
    };
    const double top = kTopOfLongEcho * echo.height();
    time.edge = edge_at(std::min(timing.threshold_pe, top));
    if (timing.threshold_pe > top && echo.height() > kClearlyAbove * timing.threshold_pe)
      time.edge = std::min(edge_at(timing.threshold_pe), kLongestEdge * time.edge);
  }
  return time;
}

/// A block of echoes, with the positions of its rays.
class EchoBlock {
 public:
  EchoBlock(const EchoRays& rays, double sigma_m)
      : rays_(rays), sigma_m_(sigma_m), x_(rays.rays_per_echo() * EchoRays::kBlock) {}

  /// Moves to the block that begins with this echo.
  void begin(std::size_t first) {
    first_ = first;
    for (std::size_t i = 0; i < EchoRays::kBlock; ++i)
      if (first + i < rays_.size()) sums_[i] = center(first + i);
  }

  void time(const EchoTiming& timing, std::span<Echo> echoes) const {
    BlockTimes times;
    const double* const pe = rays_.signals_pe().data() + rays_.index(first_, 0);
    HWY_DYNAMIC_DISPATCH(TimeBlock)(x_.data(), pe, rays_.rays_per_echo(), timing, times);
    for (std::size_t i = 0; i < EchoRays::kBlock && first_ + i < rays_.size(); ++i) {
      EchoTime time{times.at[i], times.height[i], times.edge[i]};
      if (sums_[i].length > kLongEcho) time = time_long_echo(long_echo(i), timing);
      echoes[first_ + i] = echo(sums_[i], time, timing);
    }
  }

 private:
  [[nodiscard]] EchoSums center(std::size_t echo) {
    const auto range = rays_.ranges_m();
    const auto pe = rays_.signals_pe();
    EchoSums sums;
    const double reference_m = range[rays_.index(echo, 0)];
    for (std::size_t j = 0; j < rays_.rays_per_echo(); ++j) {
      const std::size_t at = rays_.index(echo, j);
      sums.signal_pe += pe[at];
      sums.mean_m += pe[at] * (range[at] - reference_m);
    }
    sums.mean_m = reference_m + sums.mean_m / sums.signal_pe;
    double nearest = std::numeric_limits<double>::infinity();
    double farthest = -nearest;
    for (std::size_t j = 0; j < rays_.rays_per_echo(); ++j) {
      const std::size_t at = rays_.index(echo, j);
      const double x = pe[at] > 0 ? (range[at] - sums.mean_m) / sigma_m_ : 0;
      x_[j * EchoRays::kBlock + echo % EchoRays::kBlock] = x;
      sums.variance += pe[at] * x * x;
      if (pe[at] > 0) {
        nearest = std::min(nearest, x);
        farthest = std::max(farthest, x);
      }
    }
    sums.variance /= sums.signal_pe;
    sums.length = farthest - nearest;
    return sums;
  }

  [[nodiscard]] LongEcho long_echo(std::size_t i) const {
    std::vector<double> x;
    std::vector<double> pe;
    for (std::size_t j = 0; j < rays_.rays_per_echo(); ++j) {
      const double signal = rays_.signals_pe()[rays_.index(first_ + i, j)];
      if (signal == 0) continue;
      x.push_back(x_[j * EchoRays::kBlock + i]);
      pe.push_back(signal);
    }
    return {std::move(x), std::move(pe)};
  }

  [[nodiscard]] Echo echo(const EchoSums& sums, const EchoTime& time, const EchoTiming& timing) const {
    const double at = timing.point == TimingPoint::centroid ? 0 : time.at;
    return {.signal_pe = sums.signal_pe,
            .peak = time.height / sums.signal_pe,
            .edge_m = timing.point == TimingPoint::leading_edge ? time.edge * sigma_m_ : 0,
            .width_m = sigma_m_ * std::sqrt(1 + sums.variance),
            .range_m = sums.mean_m + sigma_m_ * at};
  }

  const EchoRays& rays_;
  double sigma_m_;
  std::size_t first_ = 0;
  std::array<EchoSums, EchoRays::kBlock> sums_{};
  std::vector<double> x_;
};

}  // namespace

void time_echoes(const EchoRays& rays, const EchoTiming& timing, std::span<Echo> echoes) {
  assert(echoes.size() == rays.size());
  EchoBlock block(rays, timing.sigma_m);
  for (std::size_t first = 0; first < rays.size(); first += EchoRays::kBlock) {
    block.begin(first);
    block.time(timing, echoes);
  }
}

}  // namespace landfall
#endif
