// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into a tool: the OpenCL device is named "faulty device" and fails as FAULTY_OPENCL says:
//   no_doubles   it has no double precision
//   no_compiler  it compiles no kernel, with a log of two lines
//   rounds       the first number that it computes is one bit off
//   no_memory:N  no buffer can be made from the N-th on
//   lost:N       nothing can be read back from the N-th time on
// It needs no header of OpenCL: the functions are those of its C interface.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME = 0x102B, DOUBLE_CONFIG = 0x1032, BUILD_LOG = 0x1183 };
enum { ALLOCATION_FAILURE = -4, OUT_OF_RESOURCES = -5, BUILD_FAILURE = -11 };

static void* real(const char* function) {
  void* library = dlopen("libOpenCL.so.1", RTLD_LAZY | RTLD_NOLOAD);
  void* found = library == NULL ? NULL : dlsym(library, function);
  if (found == NULL) {
    fprintf(stderr, "faulty_opencl: no %s\n", function);
    abort();
  }
  return found;
}

// The number after "KIND:", 0 for "KIND" alone, -1 if another fault is asked for.
static long fault(const char* kind) {
  const char* asked = getenv("FAULTY_OPENCL");
  const size_t length = strlen(kind);
  if (asked == NULL || strncmp(asked, kind, length) != 0) return -1;
  if (asked[length] == ':') return atol(asked + length + 1);
  return asked[length] == '\0' ? 0 : -1;
}

static int32_t answer(const void* value, size_t bytes, size_t size, void* out, size_t* size_out) {
  if (size_out != NULL) *size_out = bytes;
  if (out != NULL) memcpy(out, value, bytes < size ? bytes : size);
  return 0;
}

int32_t clGetDeviceInfo(void* device, uint32_t what, size_t size, void* value, size_t* size_out) {
  static const char name[] = "faulty device";
  static const uint64_t none = 0;
  if (what == NAME) return answer(name, sizeof name, size, value, size_out);
  if (what == DOUBLE_CONFIG && fault("no_doubles") == 0) return answer(&none, sizeof none, size, value, size_out);
  int32_t (*next)(void*, uint32_t, size_t, void*, size_t*) = real("clGetDeviceInfo");
  return next(device, what, size, value, size_out);
}

int32_t clBuildProgram(void* program, uint32_t count, const void* devices, const char* options, void* notify, void* data) {
  if (fault("no_compiler") == 0) return BUILD_FAILURE;
  int32_t (*next)(void*, uint32_t, const void*, const char*, void*, void*) = real("clBuildProgram");
  return next(program, count, devices, options, notify, data);
}

int32_t clGetProgramBuildInfo(void* program, void* device, uint32_t what, size_t size, void* value, size_t* size_out) {
  static const char log[] = "line 1: no such type\nline 2: more of it\n";
  if (what == BUILD_LOG && fault("no_compiler") == 0) return answer(log, sizeof log, size, value, size_out);
  int32_t (*next)(void*, void*, uint32_t, size_t, void*, size_t*) = real("clGetProgramBuildInfo");
  return next(program, device, what, size, value, size_out);
}

void* clCreateBuffer(void* context, uint64_t flags, size_t size, void* host, int32_t* error) {
  static long made = 0;
  const long at = fault("no_memory");
  if (at >= 0 && ++made >= at) {
    if (error != NULL) *error = ALLOCATION_FAILURE;
    return NULL;
  }
  void* (*next)(void*, uint64_t, size_t, void*, int32_t*) = real("clCreateBuffer");
  return next(context, flags, size, host, error);
}

int32_t clEnqueueReadBuffer(void* queue, void* buffer, uint32_t blocking, size_t offset, size_t size, void* out, uint32_t count,
                            const void* events, void* event) {
  static long reads = 0;
  const long number = __atomic_add_fetch(&reads, 1, __ATOMIC_RELAXED);
  const long at = fault("lost");
  if (at >= 0 && number >= at) return OUT_OF_RESOURCES;
  int32_t (*next)(void*, void*, uint32_t, size_t, size_t, void*, uint32_t, const void*, void*) = real("clEnqueueReadBuffer");
  const int32_t done = next(queue, buffer, blocking, offset, size, out, count, events, event);
  if (fault("rounds") == 0 && number == 1) *(unsigned char*)out ^= 1;
  return done;
}
