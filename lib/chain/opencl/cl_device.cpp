// SPDX-License-Identifier: GPL-3.0-or-later
// A device is checked before it is used, with 4,097 products with sums, fused products with sums,
// quotients and square roots. A driver that contracts in spite of the pragma would otherwise change ranges
// by a bit without a sign. Compiling the kernels and the check take 0.7 s of CPU time with pocl the first
// time, and 0.1 s afterwards, from the cache of its compiler.
//
// A device is used only if it is requested. `auto` never does: the result is the same, but the time
// depends on the device and its driver, and others may be using it. `opencl` fails where it cannot be
// used, because a scan that silently takes ten times as long is not what was requested; `opencl-or-cpu`
// falls back with a warning. The first usable GPU is taken, then an accelerator, then a CPU.
#include "chain/opencl/cl_device.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "chain/opencl/embedded_kernels.h"

namespace landfall {
namespace {

constexpr std::size_t kResults = 4;
constexpr std::array<const char*, kResults> kOperations = {
    "a multiplication and an addition", "a fused multiplication and addition", "a division", "a square root"};

/// Triples of numbers of full length, whose products nearly cancel, so that each rounding shows.
std::vector<double> operands() {
  std::vector<double> numbers;
  std::uint64_t state = 1;
  const auto next = [&] {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return 1 + static_cast<double>(state >> 12U) * 0x1p-52;
  };
  for (int i = 0; i < 4096; ++i) {
    const double a = next();
    const double b = next();
    numbers.insert(numbers.end(), {a, b, i % 2 == 0 ? -(a * b) * (1 + 0x1p-30) : next()});
  }
  // Subnormal results are kept.
  numbers.insert(numbers.end(), {0x1.8p-1022, 0x1.4p-3, 0x1p-1060});
  return numbers;
}

/// Says which operation a device rounds otherwise than this CPU; empty if there is none.
std::string arithmetic_problem(const cl::Device& device) {
  const std::vector<double> given = operands();
  const std::size_t count = given.size() / 3;
  std::vector<double> found(kResults * count);
  const cl::Context context(device);
  const cl::CommandQueue queue(context, device);
  cl::Kernel kernel(compiled(context, device, KernelFile::scene), "arithmetic");
  const cl::Buffer in(context, CL_MEM_READ_ONLY, given.size() * sizeof(double));
  const cl::Buffer out(context, CL_MEM_WRITE_ONLY, found.size() * sizeof(double));
  queue.enqueueWriteBuffer(in, CL_FALSE, 0, given.size() * sizeof(double), given.data());
  kernel.setArg(0, in);
  kernel.setArg(1, out);
  kernel.setArg(2, cl_ulong{count});
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(count));
  queue.enqueueReadBuffer(out, CL_TRUE, 0, found.size() * sizeof(double), found.data());
  for (std::size_t i = 0; i < count; ++i) {
    const double a = given[3 * i];
    const double b = given[3 * i + 1];
    const double c = given[3 * i + 2];
    const double product = a * b;
    const std::array<double, kResults> expected = {product + c, std::fma(a, b, c), a / b,
                                                   std::sqrt(std::abs(c))};
    for (std::size_t k = 0; k < kResults; ++k)
      if (std::bit_cast<std::uint64_t>(found[kResults * i + k]) != std::bit_cast<std::uint64_t>(expected[k]))
        return std::string("rounds ") + kOperations[k] + " otherwise than the CPU";
  }
  return "";
}

const char* kind_of(cl_device_type type) {
  if ((type & CL_DEVICE_TYPE_GPU) != 0) return "gpu";
  if ((type & CL_DEVICE_TYPE_ACCELERATOR) != 0) return "accelerator";
  return (type & CL_DEVICE_TYPE_CPU) != 0 ? "cpu" : "other";
}

/// Texts of drivers may end with spaces or a zero.
std::string trimmed(std::string text) {
  text.erase(text.find_last_not_of(std::string(" \0", 2)) + 1);
  return text;
}

}  // namespace

std::string reason_of(cl_int code) {
  switch (code) {
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
    case CL_OUT_OF_HOST_MEMORY:
      return "out of memory";
    case CL_OUT_OF_RESOURCES:
      return "out of resources, or the device is lost";
    case CL_DEVICE_NOT_AVAILABLE:
      return "the device is not available";
    case CL_INVALID_BUFFER_SIZE:
      return "more memory in one piece than it allows";
    default:
      return "OpenCL error " + std::to_string(code);
  }
}

std::vector<cl::Device> all_devices() {
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    return {};  // the library reports the absence of drivers as an error
  }
  std::vector<cl::Device> all;
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> devices;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
    } catch (const cl::Error&) {
      continue;  // the same for a driver without a device
    }
    all.insert(all.end(), devices.begin(), devices.end());
  }
  return all;
}

OpenClDevice described(const cl::Device& device) {
  OpenClDevice found;
  found.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
  try {
    found.platform = trimmed(cl::Platform(device.getInfo<CL_DEVICE_PLATFORM>()).getInfo<CL_PLATFORM_NAME>());
    found.driver = trimmed(device.getInfo<CL_DRIVER_VERSION>());
    found.kind = kind_of(device.getInfo<CL_DEVICE_TYPE>());
    found.memory_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
    found.has_doubles = device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0;
    found.problem = found.has_doubles ? arithmetic_problem(device) : "has no double precision";
  } catch (const cl::Error& error) {
    found.problem = "failed (" + reason_of(error.err()) + ")";
  } catch (const DeviceError& error) {
    found.problem = error.what();
  }
  return found;
}

const std::vector<OpenClDevice>& described_devices() {
  static const std::vector<OpenClDevice> all = [] {
    std::vector<OpenClDevice> found;
    for (const cl::Device& device : all_devices()) found.push_back(described(device));
    return found;
  }();
  return all;
}

cl::Program compiled(const cl::Context& context, const cl::Device& device, KernelFile file) {
  const auto text_of = [](KernelFile of) {
    return std::string(embedded::kKernels[static_cast<std::size_t>(of)].text);
  };
  cl::Program::Sources texts = {text_of(file)};
  if (file != KernelFile::scene) texts.insert(texts.begin(), text_of(KernelFile::scene));
  cl::Program program(context, texts);
  try {
    program.build({device}, "-cl-std=CL1.2");
  } catch (const cl::Error&) {
    const std::string log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
    throw DeviceError("cannot compile the kernels (" + log.substr(0, log.find('\n')) + ")");
  }
  return program;
}

}  // namespace landfall
