// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/opencl/devices.h"

#include <gtest/gtest.h>

#include "no_opencl.h"
#include "refusal.h"

namespace landfall {
namespace {

OpenClDevice device_of(const char* name, const char* kind, const char* problem = "") {
  return {.name = name, .kind = kind, .has_doubles = true, .problem = problem};
}

TEST(OpenClDeviceChoice, PrefersTheFirstUsableGpu) {
  EXPECT_EQ(default_device({device_of("a", "cpu")}), 0U);
  EXPECT_EQ(default_device({device_of("a", "cpu"), device_of("b", "accelerator")}), 1U);
  EXPECT_EQ(default_device({device_of("a", "accelerator"), device_of("b", "gpu", "has no double precision"),
                            device_of("c", "gpu", "rounds a division"), device_of("d", "gpu"),
                            device_of("e", "gpu")}),
            3U);
  EXPECT_EQ(default_device({device_of("a", "gpu", "has no double precision"), device_of("b", "cpu")}), 1U);
}

std::string refusal_of_devices(const std::vector<OpenClDevice>& devices) {
  return refusal<DeviceError>([&] { return default_device(devices); });
}

TEST(OpenClDeviceChoice, SaysWhyThereIsNone) {
  EXPECT_EQ(refusal_of_devices({}), "OpenCL: there is no device, or no driver of it is installed");
  EXPECT_EQ(refusal_of_devices({device_of("a", "gpu", "has no double precision")}),
            "OpenCL: no device can be used: a has no double precision");
  EXPECT_EQ(refusal_of_devices({device_of("a", "gpu", "has no double precision"),
                                device_of("b", "cpu", "rounds a division")}),
            "OpenCL: no device can be used: a has no double precision, and b rounds a division");
}

TEST(OpenClDeviceUse, CountsAndKeepsTheFirstFailure) {
  DeviceUse use;
  use.count_draw();
  use.count_draw();
  use.name_device("d");
  EXPECT_FALSE(use.failure());
  use.fell_back("first");
  use.fell_back("second");
  EXPECT_EQ(use.draws(), 2U);
  EXPECT_EQ(use.device(), "d");
  EXPECT_EQ(use.failure(), "first");
}

TEST(OpenClDeviceChoice, ChosenDeviceMustExist) {
  if (!no_opencl().empty()) GTEST_SKIP() << no_opencl();
  EXPECT_THROW(static_cast<void>(usable_device(1000)), UsageError);
}

}  // namespace
}  // namespace landfall
