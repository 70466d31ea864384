// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/numerics/random.h"
#include "base/returns/pulse_pixel.h"
#include "chain/lidar/receiver/echo.h"
#include "chain/lidar/receiver/echo_timing.h"

namespace landfall {

enum class ReceiverType {
  none,               ///< no waveform: a pixel reports the range that its detector estimates
  leading_edge,       ///< the time when the signal first exceeds a fixed threshold
  constant_fraction,  ///< ... a fixed fraction of its maximum
  peak,               ///< the time of the maximum
  centroid,           ///< the mean time of the signal
  geiger,             ///< the time of the first photoelectron
};

/// The echoes of a pixel that a receiver reports.
enum class ReportedReturns { first, last, strongest, all };

struct ReceiverParameters {
  ReceiverType type = ReceiverType::none;
  /// Full width at half maximum of the Gaussian pulse, as the receiver sees it; > 0
  double pulse_fwhm_s = 1e-9;
  /// An echo is detected where its maximum reaches that of an unstretched one of so many photoelectrons; > 0
  double threshold_pe = 20;
  double fraction = 0.5;   ///< of constant_fraction, in (0, 1)
  double dead_time_s = 0;  ///< of geiger, after each photoelectron, >= 0
  /// Mean photoelectrons of a pixel and pulse that are not signal, over the whole gate; >= 0
  double background_pe = 0;
  double gate_begin_m = 0;  ///< the range gate, 0 <= begin < end
  double gate_end_m = 1000;
  bool photon_noise = true;      ///< false: counts and times are their means
  bool walk_correction = false;  ///< of leading_edge, by the measured signal
  ReportedReturns returns = ReportedReturns::first;
  int max_returns = 5;  ///< of `all`, in 1..5
};

/// One return as a receiver reports it.
struct Detection {
  double range_m = std::numeric_limits<double>::quiet_NaN();  ///< NaN: nothing was detected
  float intensity_pe = std::numeric_limits<float>::quiet_NaN();
  bool is_background = false;  ///< a photoelectron that is not signal
};

/// The waveforms of all pixels of a pulse.
struct Waveforms {
  EchoRays rays;
  std::vector<std::size_t> first_echo{0};  ///< of each pixel, and the number of all echoes at the end
  std::vector<Echo> echoes;                ///< empty for geiger

  void clear(std::size_t rays_per_pixel);
  [[nodiscard]] std::span<const Echo> of(std::size_t pixel) const {
    return std::span(echoes).subspan(first_echo[pixel], first_echo[pixel + 1] - first_echo[pixel]);
  }
};

/// The reports of a receiver of the light that its pixels see. A pulse of the standard deviation sigma_t =
/// fwhm/2.3548 (sigma = c sigma_t/2 as a range) returns from every sub-ray (echo.h); two echoes are apart
/// where no sub-ray lies within one FWHM between them.
///
/// Linear types. Echo of mean N and maximum N p: its photoelectrons n are Poisson distributed with the mean N
/// + b, less the mean b of the background within one FWHM. It is detected where n p >= threshold_pe.
/// Reported, against the echo's true time:
///
/// - leading_edge: r_max - edge sqrt(2 ln(n p/threshold_pe)). walk_correction adds
///   sigma sqrt(2 ln(n/threshold_pe)), which makes echoes that are not stretched exact;
/// - constant_fraction: the crossing plus sigma sqrt(2 ln(1/fraction)), exact for echoes that are not
///   stretched;
/// - peak, centroid: the maximum, the mean;
///
/// and to each a normal error of the echo's width s times sqrt(n + 3.01 b s/sigma)/n: the Cramer-Rao bound of
/// the time of a Gaussian signal without background, and of a weak one; between them up to 9 % below it.
/// `first` reports the first echo that is detected, as the first row of `all`. `last` and `strongest` choose
/// one of the echoes with N p >= threshold_pe, the last or that of the largest N, before it is detected;
/// without any such echo, that of the largest N p.
///
/// geiger. Sub-ray j emits photoelectrons as an independent Poisson process of the mean e_j and the pulse's
/// shape, the background one of constant rate over the gate, which does not limit the signal. The first
/// photoelectron is timed; then the pixel is blind for dead_time_s, and of an echo that begins meanwhile
/// nothing is seen. Of each echo only the first photoelectron counts. Its intensity is 1.
///
/// Every draw is a function of (seed, draw, cause, pulse, pixel, number of the echo); the number is 0 for an
/// echo that `last` or `strongest` chose. The draws of geiger follow the sub-rays in the order of add_pixel()
/// if all lie within one FWHM, else in the order of range.
class Receiver {
 public:
  Receiver() : Receiver({}, 0) {}
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  Receiver(const ReceiverParameters& parameters, RandomSeed seed);

  [[nodiscard]] ReceiverType type() const { return parameters_.type; }
  /// False: pixels report the ranges of their detector.
  [[nodiscard]] bool uses_waveforms() const { return parameters_.type != ReceiverType::none; }
  /// True: the detections follow from the echoes that keep_echoes() keeps. False: it needs whole waveforms.
  [[nodiscard]] bool accepts_kept_echoes() const {
    return parameters_.type != ReceiverType::geiger && parameters_.returns != ReportedReturns::all;
  }
  /// True: also from echoes behind a pixel's first one.
  [[nodiscard]] bool accepts_later_echoes() const {
    return accepts_kept_echoes() && uses_waveforms() && parameters_.returns == ReportedReturns::first;
  }
  [[nodiscard]] std::size_t max_returns() const {
    return parameters_.returns == ReportedReturns::all ? static_cast<std::size_t>(parameters_.max_returns)
                                                       : 1;
  }

  /// Appends the next pixel: the ranges and mean photoelectrons of its sub-rays, NaN for a miss. May reorder
  /// them.
  void add_pixel(std::span<double> ranges_m, std::span<double> signals_pe, Waveforms& waveforms) const;
  /// Times the echoes of all pixels; call after the last add_pixel().
  void time(Waveforms& waveforms) const;
  /// The echoes from which receive() follows; accepts_kept_echoes() must hold. `kept`: of each pixel the
  /// first one, or that which `last` or `strongest` chooses, without signal where a pixel has none. The
  /// echoes behind the first ones are appended to `later`, in the order of pixel and number, if the receiver
  /// accepts them.
  void keep_echoes(std::int64_t pulse, const Waveforms& waveforms, std::span<Echo> kept,
                   std::vector<LaterEcho>& later) const;

  /// The detections of kept echoes, one for each pixel; accepts_kept_echoes() must hold. `later`: those of
  /// this pulse.
  void receive(std::int64_t pulse, std::span<const Echo> kept, std::span<const LaterEcho> later,
               std::span<Detection> out) const;
  /// The detections of whole waveforms: max_returns() for each pixel, those detected first.
  void receive(std::int64_t pulse, const Waveforms& waveforms, std::span<Detection> out) const;

 private:
  struct PhotonDraw {
    double count_normal = 0;
    double time_normal = 0;
  };
  [[nodiscard]] Detection receive_echo(const Echo& echo, const PulsePixel& where,
                                       const PhotonDraw& draw) const;
  [[nodiscard]] Detection receive_echo(const Echo& echo, const PulsePixel& where) const;
  [[nodiscard]] const Echo& chosen(std::span<const Echo> echoes) const;
  void receive_kept(std::int64_t pulse, std::span<const Echo> kept, std::span<Detection> out) const;
  /// One sigma of the time of an echo in which so many photoelectrons of signal were counted.
  [[nodiscard]] double timing_sigma_m(const Echo& echo, double signal_pe) const;
  void receive_linear(PulsePixel where, std::span<const Echo> echoes, std::span<Detection> out) const;
  void receive_geiger(PulsePixel where, const Waveforms& waveforms, std::span<Detection> out) const;
  /// The first photoelectrons of a pixel's echoes, nearest first.
  [[nodiscard]] std::vector<double> photons_m(PulsePixel where, const Waveforms& waveforms) const;
  [[nodiscard]] double first_photon_m(const EchoRays& rays, std::size_t echo, const PulsePixel& where) const;

  ReceiverParameters parameters_;
  double sigma_m_;
  double background_in_pulse_pe_;
  double fraction_offset_m_ = 0;
  RandomField count_;
  RandomField time_;
  RandomField background_;
};

}  // namespace landfall
