// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/devices.h"

#include <vector>

#include "app/cli/print.h"
#include "chain/opencl/devices.h"

namespace landfall::cli {
namespace {

nlohmann::ordered_json described(const OpenClDevice& device) {
  return {
      {"name", device.name},       {"platform", device.platform},         {"driver", device.driver},
      {"kind", device.kind},       {"memory_bytes", device.memory_bytes}, {"has_doubles", device.has_doubles},
      {"problem", device.problem}, {"is_usable", device.is_usable()}};
}

std::string device_line(const char* name, const std::string& value) {
  return print("  %-9s ", name) + value + "\n";
}

std::string use_text(const nlohmann::ordered_json& device) {
  return device.at("is_usable") ? "draws of monte-carlo" : "none: " + device.at("problem").get<std::string>();
}

}  // namespace

nlohmann::ordered_json device_list() {
  const std::vector<OpenClDevice> devices = opencl_devices();
  if (devices.empty()) static_cast<void>(default_device(devices));  // says so
  nlohmann::ordered_json list;
  for (const OpenClDevice& device : devices) list["devices"].push_back(described(device));
  return list;
}

std::string devices_text(const nlohmann::ordered_json& list) {
  std::string text;
  for (const nlohmann::ordered_json& device : list.at("devices")) {
    text += device.at("name").get<std::string>() + "\n";
    text += device_line("kind", device.at("kind"));
    text += device_line(
        "driver", device.at("platform").get<std::string>() + " " + device.at("driver").get<std::string>());
    text += device_line("memory", print("%.3g GB", device.at("memory_bytes").get<double>() / 1e9));
    text += device_line("doubles", device.at("has_doubles") ? "yes" : "no");
    text += device_line("use", use_text(device));
  }
  return text;
}

}  // namespace landfall::cli
