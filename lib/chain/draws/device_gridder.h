// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chain/gridding/accumulator.h"
#include "chain/gridding/method.h"
#include "chain/lidar/simulation/simulation.h"
#include "chain/opencl/device_draws.h"
#include "chain/opencl/devices.h"

namespace landfall {

/// Why a device cannot make a draw: a key of monte-carlo's configuration, and the reason.
struct DeviceRefusal {
  const char* key;     ///< "scan/receiver/type"
  const char* reason;  ///< "a device computes no waveforms"
};

/// Redraws the errors of a scan and bins the returns on an OpenCL device: what DrawGridder does on the CPU,
/// bit for bit. The CPU steers the beams once, for all draws, and computes the estimated pose of each pulse
/// and the map of dead pixels for each draw. The device draws dropouts, false returns and noise, computes the
/// points and adds them to the bins, each bin in the order of the scan. It keeps 64 bytes per pixel and
/// pulse, 192 per pulse, 116 per bin, and 44 (bilinear4: 56) for each beam of 2^20, or of a pulse if it has
/// more.
///
/// Methods bilinear_nearest, mean and bilinear4. No receiver that sees waveforms, no errors of the timer, no
/// beams that the lander knows wrongly.
class DeviceGridder {
 public:
  /// Chooses the device: throws DeviceError or, with DeviceFailure::falls_back, leaves all draws to the CPU.
  /// `truth` must outlive this object.
  DeviceGridder(const TrueRanges& truth, const GridSpec& grid, const OpenClOptions& options);

  /// The reason why the device cannot make this draw; nothing if it can.
  [[nodiscard]] std::optional<DeviceRefusal> refusal(const Simulation& simulation, Method method) const;
  /// Throws UsageError, naming the key, where there is a refusal, unless the CPU then makes the draw.
  void check(const Simulation& simulation, Method method) const;

  /// Makes a draw. All simulations must have the beams and true poses of the first. Returns false, having
  /// done nothing, where the CPU is to make it; DeviceUse then says why. Throws as check() does, DeviceError
  /// if the device fails, and as Simulation::prepare_replay() does.
  [[nodiscard]] bool draw(const Simulation& simulation, Method method);
  /// Makes a draw as draw() does, and passes the device, which holds its bins, to `finish`. Returns what that
  /// returns: false leaves the draw to the CPU.
  [[nodiscard]] bool make(const Simulation& simulation, Method method,
                          const std::function<bool(DeviceDraws&)>& finish);
  /// Passes the device to `work`. Returns false if there is none, or if it failed and the CPU takes over.
  [[nodiscard]] bool attempt(const std::function<void(DeviceDraws&)>& work);
  /// count, z_est, x_true, y_true, x_offset and y_offset of the last draw(); the other values are NaN.
  void values(BinIndex first, std::span<BinValues> out) const;

 private:
  void forget_device();
  void load(const Simulation& simulation);
  [[nodiscard]] std::unique_ptr<DeviceDraws> empty_scan(const Simulation& simulation) const;
  void load_pulses(const Simulation& simulation, PulseSpan pulses);
  [[nodiscard]] std::vector<DevicePose> estimated_poses(const Simulation& simulation) const;
  [[nodiscard]] std::string text_of(const DeviceRefusal& refusal) const;

  TrueRanges truth_;
  GridSpec grid_;
  DeviceFailure on_failure_;
  std::shared_ptr<DeviceUse> use_;
  std::optional<std::size_t> device_;  ///< none after a failure
  std::unique_ptr<DeviceDraws> draws_;
  bool knows_incidences_ = false;  ///< draws_
  std::vector<double> layers_;
  std::vector<std::int32_t> counts_;
};

}  // namespace landfall
