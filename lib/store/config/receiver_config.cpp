// SPDX-License-Identifier: GPL-3.0-or-later
// Settings without effect are warned about, not refused, so that a study can vary the receiver's type with
// the other keys set.
#include "store/config/receiver_config.h"

#include <algorithm>
#include <array>
#include <optional>

#include "base/core/error.h"
#include "base/numerics/portable_math.h"
#include "base/text/number_text.h"
#include "chain/lidar/detector/pixel_table.h"
#include "chain/lidar/receiver/link_budget.h"
#include "store/config/config_path.h"
#include "store/config/json_values.h"
#include "store/config/schema.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

ReceiverType type_of(const Json& receiver) {
  const auto type = receiver.at("type").get<std::string>();
  if (type == "leading_edge") return ReceiverType::leading_edge;
  if (type == "constant_fraction") return ReceiverType::constant_fraction;
  if (type == "peak") return ReceiverType::peak;
  if (type == "centroid") return ReceiverType::centroid;
  return type == "geiger" ? ReceiverType::geiger : ReceiverType::none;
}

ReportedReturns returns_of(const Json& receiver) {
  const auto returns = receiver.at("returns").get<std::string>();
  if (returns == "last") return ReportedReturns::last;
  if (returns == "strongest") return ReportedReturns::strongest;
  return returns == "all" ? ReportedReturns::all : ReportedReturns::first;
}

Illumination make_illumination(const Json& beam) {
  const auto [x, y] = pair_of(beam.at("offset_rad"));
  return Illumination(
      {.profile = beam.at("profile") == "top_hat" ? BeamProfile::top_hat : BeamProfile::gaussian,
       .divergence_rad = beam.contains("divergence_rad")
                             ? std::optional(beam.at("divergence_rad").get<double>())
                             : std::nullopt,
       .offset_x_rad = x,
       .offset_y_rad = y});
}

double pixel_sr(const Json& detector) {
  if (detector.at("distribution").is_object())
    throw UsageError("pulse_energy_J: the solid angles of pixels in a table are unknown; use reference_pe");
  const double fill = detector.at("fill_factor").get<double>();
  if (detector.contains("ifov_rad")) {
    const auto [x, y] = pair_of(detector.at("ifov_rad"));
    return fill * x * y;
  }
  const auto [x, y] = pair_of(detector.at("fov_deg"));
  const auto pitch = [](double fov_deg, const Json& pixels) {
    return 2 * portable::tan(kRadiansPerDegree * fov_deg / 2) / pixels.get<double>();
  };
  return fill * pitch(x, detector.at("columns")) * pitch(y, detector.at("rows"));
}

/// The number at a key that others need.
double needed(const Json& link, const char* key, const char* by) {
  if (!link.contains(key)) throw UsageError(std::string(key) + ": is missing; " + by + " needs it");
  return link.at(key).get<double>();
}

double link_constant(const Json& link, const Json& detector, const Illumination& beam) {
  constexpr std::array kDesign = {"pulse_energy_J", "wavelength_m", "aperture_m", "efficiency"};
  const auto given = std::ranges::find_if(kDesign, [&](const char* key) { return link.contains(key); });
  if (link.contains("reference_pe") || link.contains("reference_range_m")) {
    if (given != kDesign.end())
      throw UsageError(std::string(*given) + ": excludes reference_pe; give one of them");
    return link_constant_pe_m2(ReferenceSignal{needed(link, "reference_pe", "reference_range_m"),
                                               needed(link, "reference_range_m", "reference_pe")});
  }
  if (given == kDesign.end())
    throw UsageError("reference_pe: is missing; every receiver but \"none\" needs it or pulse_energy_J");
  const auto number_of = [&](const char* key) { return needed(link, key, *given); };
  return link_constant_pe_m2(
      LinkDesign{number_of(kDesign[0]), number_of(kDesign[1]), number_of(kDesign[2]), number_of(kDesign[3])},
      pixel_sr(detector), beam);
}

/// A key of /receiver and the types that it concerns.
struct KeyUse {
  const char* key;
  std::initializer_list<const char*> types;
};

}  // namespace

Receiver make_receiver(const Json& resolved, const ComponentContext& context) {
  const Json& json = resolved.at("receiver");
  const auto [gate_begin, gate_end] = pair_of(resolved.at("noise").at("false_range_m"));
  ReceiverParameters receiver{.type = type_of(json),
                              .pulse_fwhm_s = number(json, "pulse_fwhm_s"),
                              .threshold_pe = number(json, "threshold_pe"),
                              .fraction = number(json, "fraction"),
                              .dead_time_s = number(json, "dead_time_s"),
                              .background_pe = number(resolved.at("link"), "background_pe"),
                              .gate_begin_m = gate_begin,
                              .gate_end_m = gate_end,
                              .photon_noise = json.at("photon_noise").get<bool>(),
                              .walk_correction = json.at("walk_correction").get<bool>(),
                              .returns = returns_of(json),
                              .max_returns = json.at("max_returns").get<int>()};
  return at_path("receiver/", [&] {
    if (receiver.type != ReceiverType::none) {
      if (resolved.at("detector").at("estimator") != "mean")
        throw UsageError("type: excludes /detector/estimator, which joins ranges without a waveform");
      const double interval_s = 1 / number(resolved.at("laser"), "pulse_rate_hz");
      if (receiver.type == ReceiverType::geiger && receiver.dead_time_s > interval_s)
        throw UsageError("dead_time_s: is longer than the " + number_text(interval_s) +
                         " s between two pulses, in which a pixel recovers");
    }
    if (receiver.type == ReceiverType::none) receiver.returns = ReportedReturns::first;
    return Receiver(receiver, context.seed);
  });
}

RangeTimer make_range_timer(const Json& resolved, const ComponentContext& context) {
  const Json& json = resolved.at("receiver");
  const int rows = resolved.at("detector").at("rows").get<int>();
  const int columns = resolved.at("detector").at("columns").get<int>();
  return at_path("receiver/", [&] {
    RangeTimerParameters timer{.jitter_sigma_s = number(json, "jitter_sigma_s"),
                               .pixel_offset_sigma_m = number(json, "pixel_offset_sigma_m"),
                               .clock_scale_ppm = number(json, "clock_scale_ppm"),
                               .timer_step_s = number(json, "timer_step_s")};
    if (json.contains("pixel_offset_table")) {
      if (timer.pixel_offset_sigma_m != 0)
        throw UsageError("pixel_offset_table: excludes pixel_offset_sigma_m; give one of them");
      const auto path = json.at("pixel_offset_table").at("path").get<std::string>();
      if (context.load_table)
        timer.pixel_offset_m =
            pixel_offsets_m(context.load_table(path, "offsets", pixel_offset_columns()), rows, columns);
    }
    return RangeTimer(std::move(timer), static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns),
                      context.seed);
  });
}

std::vector<double> make_link_constants(const Json& resolved, const Detector& detector) {
  const Illumination beam = at_path("beam/", [&] { return make_illumination(resolved.at("beam")); });
  if (type_of(resolved.at("receiver")) == ReceiverType::none) return {};
  const double whole_pixel =
      at_path("link/", [&] { return link_constant(resolved.at("link"), resolved.at("detector"), beam); });
  const Json& albedo = resolved.at("surface").at("albedo");
  const double per_sample = whole_pixel * (albedo.is_number() ? albedo.get<double>() : 1) /
                            static_cast<double>(detector.samples_per_pixel());
  std::vector<double> constants;
  constants.reserve(detector.samples().size());
  for (const Direction<LidarFrame>& sample : detector.samples())
    constants.push_back(per_sample * beam.relative(sample));
  if (std::ranges::all_of(constants, [](double constant) { return constant == 0; }))
    throw UsageError("beam/divergence_rad: no pixel looks into the beam");
  return constants;
}

bool uses_albedo_map(const Json& resolved) {
  return type_of(resolved.at("receiver")) != ReceiverType::none &&
         resolved.at("surface").at("albedo").is_string();
}

std::vector<std::string> receiver_warnings(const Json& resolved) {
  static const std::array kUses = {
      KeyUse{"threshold_pe", {"leading_edge", "constant_fraction", "peak", "centroid"}},
      KeyUse{"fraction", {"constant_fraction"}},
      KeyUse{"dead_time_s", {"geiger"}},
      KeyUse{"photon_noise", {"leading_edge", "constant_fraction", "peak", "centroid"}},
      KeyUse{"walk_correction", {"leading_edge"}},
      KeyUse{"pulse_fwhm_s", {"leading_edge", "constant_fraction", "peak", "centroid", "geiger"}},
      KeyUse{"returns", {"leading_edge", "constant_fraction", "peak", "centroid", "geiger"}},
      KeyUse{"max_returns", {"leading_edge", "constant_fraction", "peak", "centroid", "geiger"}}};
  const Json& receiver = resolved.at("receiver");
  const auto type = receiver.at("type").get<std::string>();
  const Json schema = embedded_schema("scan").at("properties").at("receiver").at("properties");
  const auto is_set = [&](const char* key) { return receiver.at(key) != schema.at(key).at("default"); };
  std::vector<std::string> warnings;
  for (const auto& [key, types] : kUses)
    if (is_set(key) && std::ranges::find(types, type) == types.end())
      warnings.push_back("/receiver/" + std::string(key) + " has no effect with the receiver type " + type);
  if (type != "none" && receiver.at("returns") != "all" && is_set("max_returns"))
    warnings.emplace_back("/receiver/max_returns has no effect unless returns is all");
  if (type == "geiger" && receiver.at("returns") == "first" && is_set("dead_time_s"))
    warnings.emplace_back("/receiver/dead_time_s has no effect if returns is first");
  const Json& beam = resolved.at("beam");
  const bool shifts_beam = beam.at("offset_rad") != Json({0, 0});
  const bool shapes_beam = beam.at("profile") != "gaussian";
  if (type != "none") {
    if (resolved.at("detector").at("subpixels") == 1)
      warnings.push_back("/detector/subpixels is 1: the receiver " + type +
                         " sees one ray of each pixel, so that no echo is stretched or mixed");
    if (!beam.contains("divergence_rad") && shapes_beam)
      warnings.emplace_back("/beam/profile has no effect without /beam/divergence_rad");
    if (!beam.contains("divergence_rad") && shifts_beam)
      warnings.emplace_back("/beam/offset_rad has no effect without /beam/divergence_rad");
    if (type != "geiger" && receiver.at("photon_noise") == false &&
        resolved.at("link").at("background_pe") != 0)
      warnings.emplace_back("/link/background_pe has no effect without /receiver/photon_noise");
    return warnings;
  }
  const auto warn_of = [&](const char* section) {
    warnings.push_back("/" + std::string(section) + " has no effect without a receiver (/receiver/type)");
  };
  if (beam.contains("divergence_rad") || shapes_beam || shifts_beam) warn_of("beam");
  if (resolved.at("surface").at("albedo") != 1) warn_of("surface");
  if (resolved.at("link").size() > 1 || resolved.at("link").at("background_pe") != 0) warn_of("link");
  return warnings;
}

}  // namespace landfall
