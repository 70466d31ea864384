// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/returns/pulse_pixel.h"

namespace landfall {

/// One echo of a pixel: what a receiver must know of its waveform
///   w(r) = sum_j e_j exp(-(r - r_j)^2/(2 sigma^2)),
/// e_j the mean photoelectrons of sub-ray j, r_j its range, sigma = c/2 times the pulse's standard deviation.
/// Times are given as ranges, c t/2.
struct Echo {
  double signal_pe = 0;  ///< N = sum_j e_j; 0: no echo
  double peak = 0;       ///< maximum of w over N, in (0, 1]; 1: the echo is not stretched
  /// leading_edge: sigma of a Gaussian edge through the maximum and the point where w crosses the threshold.
  /// If the sub-rays span more than one sigma, it is at most 1.5 times that of the crossing of exp(-1/2) of
  /// the maximum, which replaces it below the threshold; a shorter echo below it has the sigma of the
  /// maximum's curvature. Else 0
  double edge_m = 0;
  double width_m = 0;  ///< standard deviation of w, >= sigma
  /// of the maximum (leading_edge, peak), the crossing (constant_fraction) or the mean (centroid)
  double range_m = 0;
  friend bool operator==(const Echo&, const Echo&) = default;
};

/// An echo of a pixel behind its first one.
struct LaterEcho {
  PulsePixel where;  ///< number >= 1
  Echo echo;
  friend bool operator==(const LaterEcho&, const LaterEcho&) = default;
};

/// The sub-rays of the echoes of a pulse, in blocks of kBlock echoes side by side, as the timing's SIMD lanes
/// read them.
class EchoRays {
 public:
  static constexpr std::size_t kBlock = 8;

  /// Forgets all echoes. An echo will have at most `rays_per_pixel` sub-rays.
  void clear(std::size_t rays_per_pixel);
  /// Adds the echoes of the next pixel, nearest first, and returns their number. A sub-ray of NaN range or
  /// without signal is left out. Two neighbouring ranges belong to different echoes where they differ by more
  /// than `gap_m`. The call may reorder both spans, which have one length.
  std::size_t add_pixel(std::span<double> ranges_m, std::span<double> signals_pe, double gap_m);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t rays_per_echo() const { return rays_; }
  /// The index of sub-ray j of an echo; the next echo of the block follows.
  [[nodiscard]] std::size_t index(std::size_t echo, std::size_t j) const {
    return (echo / kBlock * rays_ + j) * kBlock + echo % kBlock;
  }
  /// 0 where the echo has no such sub-ray.
  [[nodiscard]] std::span<const double> ranges_m() const { return ranges_m_; }
  [[nodiscard]] std::span<const double> signals_pe() const { return signals_pe_; }

 private:
  void add_echo(std::span<const double> ranges_m, std::span<const double> signals_pe);

  std::size_t rays_ = 1;
  std::size_t size_ = 0;
  std::vector<double> ranges_m_;
  std::vector<double> signals_pe_;
  std::vector<std::size_t> order_;
  std::vector<double> sorted_;
};

}  // namespace landfall
