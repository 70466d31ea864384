// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D343, D344, D345
#include "chain/lidar/receiver/receiver.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/core/error.h"
#include "base/numerics/elementary.h"
#include "base/numerics/light.h"
#include "base/numerics/poisson.h"
#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

/// Full width at half maximum over standard deviation of a Gaussian: 2 sqrt(2 ln 2).
constexpr double kFwhmPerSigma = 2.3548200450309493;

/// The variance of a time that a photoelectron of the background within one FWHM adds, over that of one of
/// the signal: 4 sqrt(pi)/kFwhmPerSigma, the Cramer-Rao bound of a weak Gaussian on a constant
/// background.
constexpr double kBackgroundWeight = 3.01076739115701;

double walk(double ratio) { return std::sqrt(2 * natural_log(ratio)); }

EchoTiming timing_of(const ReceiverParameters& p, double sigma_m) {
  const auto point = [&] {
    if (p.type == ReceiverType::leading_edge) return TimingPoint::leading_edge;
    if (p.type == ReceiverType::constant_fraction) return TimingPoint::constant_fraction;
    return p.type == ReceiverType::centroid ? TimingPoint::centroid : TimingPoint::peak;
  };
  return {point(), sigma_m, p.threshold_pe, p.fraction};
}

double peak_pe(const Echo& echo) { return echo.signal_pe * echo.peak; }

}  // namespace

void Waveforms::clear(std::size_t rays_per_pixel) {
  rays.clear(rays_per_pixel);
  first_echo.assign(1, 0);
  echoes.clear();
}

Receiver::Receiver(const ReceiverParameters& p, RandomSeed seed)
    : parameters_(p),
      sigma_m_(range_of_time_m(p.pulse_fwhm_s) / kFwhmPerSigma),
      background_in_pulse_pe_(p.background_pe * range_of_time_m(p.pulse_fwhm_s) /
                              (p.gate_end_m - p.gate_begin_m)),
      count_(seed, RandomStream::photon_count),
      time_(seed, RandomStream::photon_time),
      background_(seed, RandomStream::background) {
  require_positive({"", "pulse_fwhm_s"}, p.pulse_fwhm_s);
  require_positive({"", "threshold_pe"}, p.threshold_pe);
  require(p.fraction > 0 && p.fraction < 1, {"", "fraction"}, p.fraction, "in (0, 1)");
  require_not_negative({"", "dead_time_s"}, p.dead_time_s);
  require_not_negative({"", "background_pe"}, p.background_pe);
  require(p.max_returns >= 1 && p.max_returns <= 5, {"", "max_returns"}, p.max_returns, "in 1..5");
  if (p.type == ReceiverType::geiger && p.returns == ReportedReturns::strongest)
    throw UsageError(
        "returns: a Geiger-mode pixel measures no signal, so none of its returns is the strongest");
  if (p.type == ReceiverType::constant_fraction) fraction_offset_m_ = sigma_m_ * walk(1 / p.fraction);
}

void Receiver::add_pixel(std::span<double> ranges_m, std::span<double> signals_pe,
                         Waveforms& waveforms) const {
  waveforms.rays.add_pixel(ranges_m, signals_pe, kFwhmPerSigma * sigma_m_);
  waveforms.first_echo.push_back(waveforms.rays.size());
}

void Receiver::time(Waveforms& waveforms) const {
  if (parameters_.type == ReceiverType::geiger) return;
  waveforms.echoes.resize(waveforms.rays.size());
  time_echoes(waveforms.rays, timing_of(parameters_, sigma_m_), waveforms.echoes);
}

const Echo& Receiver::chosen(std::span<const Echo> echoes) const {
  const Echo* best = nullptr;
  for (const Echo& echo : echoes) {
    if (peak_pe(echo) < parameters_.threshold_pe) continue;
    const bool better =
        best == nullptr || parameters_.returns == ReportedReturns::last || echo.signal_pe > best->signal_pe;
    if (better) best = &echo;
  }
  return best != nullptr ? *best : *std::ranges::max_element(echoes, {}, peak_pe);
}

void Receiver::keep_echoes(std::int64_t pulse, const Waveforms& waveforms, std::span<Echo> kept,
                           std::vector<LaterEcho>& later) const {
  assert(accepts_kept_echoes() && kept.size() + 1 == waveforms.first_echo.size());
  for (std::size_t pixel = 0; pixel < kept.size(); ++pixel) {
    const std::span<const Echo> echoes = waveforms.of(pixel);
    kept[pixel] = {};
    if (echoes.empty()) continue;
    if (!accepts_later_echoes()) {
      kept[pixel] = chosen(echoes);
      continue;
    }
    kept[pixel] = echoes.front();
    for (std::size_t number = 1; number < echoes.size(); ++number)
      later.push_back(
          {{pulse, static_cast<std::int64_t>(pixel), static_cast<std::int64_t>(number)}, echoes[number]});
  }
}

double Receiver::timing_sigma_m(const Echo& echo, double signal_pe) const {
  const double background_pe = kBackgroundWeight * background_in_pulse_pe_ * echo.width_m / sigma_m_;
  return echo.width_m * std::sqrt(signal_pe + background_pe) / signal_pe;
}

Detection Receiver::receive_echo(const Echo& echo, const PulsePixel& where, const PhotonDraw& draw) const {
  const ReceiverParameters& p = parameters_;
  const double mean = echo.signal_pe;
  if (mean == 0) return {};
  double n = mean;
  if (p.photon_noise) {
    const double total = mean + background_in_pulse_pe_;
    const double uniform = total < kLargePoissonMean ? count_.uniform(where.i(), where.j()) : 0;
    n = poisson_count(total, {draw.count_normal, uniform}) - background_in_pulse_pe_;
  }
  const double ratio = n * echo.peak / p.threshold_pe;
  if (!(ratio >= 1)) return {};
  double range_m = echo.range_m + fraction_offset_m_;
  if (p.type == ReceiverType::leading_edge) {
    range_m -= echo.edge_m * walk(ratio);
    if (p.walk_correction) range_m += sigma_m_ * walk(n / p.threshold_pe);
  }
  if (p.photon_noise) range_m += timing_sigma_m(echo, n) * draw.time_normal;
  return {range_m, static_cast<float>(n)};
}

Detection Receiver::receive_echo(const Echo& echo, const PulsePixel& where) const {
  if (!parameters_.photon_noise) return receive_echo(echo, where, {});
  return receive_echo(echo, where, {count_.normal(where.i(), where.j()), time_.normal(where.i(), where.j())});
}

void Receiver::receive(std::int64_t pulse, std::span<const Echo> kept, std::span<const LaterEcho> later,
                       std::span<Detection> out) const {
  assert(accepts_kept_echoes() && kept.size() == out.size());
  receive_kept(pulse, kept, out);
  for (const LaterEcho& echo : later) {
    Detection& detection = out[static_cast<std::size_t>(echo.where.pixel)];
    if (std::isnan(detection.range_m)) detection = receive_echo(echo.echo, echo.where);
  }
}

void Receiver::receive_kept(std::int64_t pulse, std::span<const Echo> kept, std::span<Detection> out) const {
  if (!parameters_.photon_noise) {
    for (std::size_t i = 0; i < kept.size(); ++i)
      out[i] = receive_echo(kept[i], {pulse, static_cast<std::int64_t>(i)}, {});
    return;
  }
  constexpr std::size_t kAtOnce = 256;
  std::array<double, kAtOnce> counts;
  std::array<double, kAtOnce> times;
  const auto i = static_cast<std::uint64_t>(pulse);
  for (std::size_t begin = 0; begin < kept.size(); begin += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, kept.size() - begin);
    count_.normals(i, begin, std::span(counts).first(count));
    time_.normals(i, begin, std::span(times).first(count));
    for (std::size_t k = 0; k < count; ++k)
      out[begin + k] =
          receive_echo(kept[begin + k], {pulse, static_cast<std::int64_t>(begin + k)}, {counts[k], times[k]});
  }
}

void Receiver::receive(std::int64_t pulse, const Waveforms& waveforms, std::span<Detection> out) const {
  const std::size_t max_count = max_returns();
  const std::size_t pixels = waveforms.first_echo.size() - 1;
  assert(out.size() == pixels * max_count);
  std::ranges::fill(out, Detection{});
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const PulsePixel where{pulse, static_cast<std::int64_t>(pixel)};
    const auto returns = out.subspan(pixel * max_count, max_count);
    if (parameters_.type == ReceiverType::geiger) {
      receive_geiger(where, waveforms, returns);
    } else {
      receive_linear(where, waveforms.of(pixel), returns);
    }
  }
}

void Receiver::receive_linear(PulsePixel where, std::span<const Echo> echoes,
                              std::span<Detection> out) const {
  std::size_t reported = 0;
  for (const Echo& echo : echoes) {
    const Detection detection = receive_echo(echo, where);
    ++where.number;
    if (std::isnan(detection.range_m)) continue;
    out[reported++] = detection;
    if (reported == out.size()) return;
  }
}

double Receiver::first_photon_m(const EchoRays& rays, std::size_t echo, const PulsePixel& where) const {
  // The first of a process of mean e lies at the quantile E/e of the pulse's shape, E exponentially
  // distributed.
  constexpr double kMin = 1e-32;
  double first_m = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < rays.rays_per_echo(); ++j) {
    const std::size_t at = rays.index(echo, j);
    const double mean = rays.signals_pe()[at];
    if (mean == 0) continue;
    const double u = time_.uniform(where.i(), where.j() + (std::uint64_t{j + 1} << 24U));
    if (u >= mean) continue;  // -log(1 - u) >= u
    const double quantile = -natural_log(1 - u) / mean;
    if (quantile >= 1) continue;
    const double from_center = quantile > 0 ? portable::normal_quantile(std::max(quantile, kMin)) : -8.3;
    first_m = std::min(first_m, rays.ranges_m()[at] + sigma_m_ * from_center);
  }
  return first_m;
}

std::vector<double> Receiver::photons_m(PulsePixel where, const Waveforms& waveforms) const {
  const auto pixel = static_cast<std::size_t>(where.pixel);
  std::vector<double> photons_m;
  for (std::size_t echo = waveforms.first_echo[pixel]; echo < waveforms.first_echo[pixel + 1]; ++echo) {
    const double photon_m = first_photon_m(waveforms.rays, echo, where);
    ++where.number;
    if (std::isfinite(photon_m)) photons_m.push_back(photon_m);
  }
  std::ranges::sort(photons_m);  // a strong echo may begin before a weaker, nearer one
  return photons_m;
}

void Receiver::receive_geiger(PulsePixel where, const Waveforms& waveforms, std::span<Detection> out) const {
  const ReceiverParameters& p = parameters_;
  const double dead_m = range_of_time_m(p.dead_time_s);
  const double background_per_m = p.background_pe / (p.gate_end_m - p.gate_begin_m);
  const bool is_first_enough = p.returns == ReportedReturns::first;
  PulsePixel background = where;
  const auto next_background_m = [&](double after_m) {
    if (background_per_m == 0) return std::numeric_limits<double>::infinity();
    const double u = background_.uniform(background.i(), background.j());
    ++background.number;
    const double at_m = after_m - natural_log(1 - u) / background_per_m;
    return at_m < p.gate_end_m ? at_m : std::numeric_limits<double>::infinity();
  };
  std::size_t reported = 0;
  double armed_m = -std::numeric_limits<double>::infinity();
  double background_m = next_background_m(p.gate_begin_m);
  const auto report = [&](double range_m, bool is_background) {
    if (reported == out.size() && p.returns == ReportedReturns::last) reported = 0;
    if (reported < out.size()) out[reported++] = {range_m, 1, is_background};
    armed_m = range_m + dead_m;
    if (background_m < armed_m || is_background) background_m = next_background_m(armed_m);
    return !is_first_enough && (p.returns == ReportedReturns::last || reported < out.size());
  };
  for (const double photon_m : photons_m(where, waveforms)) {
    while (background_m < photon_m)
      if (!report(background_m, true)) return;
    if (photon_m >= armed_m && !report(photon_m, false)) return;
  }
  while (std::isfinite(background_m))
    if (!report(background_m, true)) return;
}

}  // namespace landfall
