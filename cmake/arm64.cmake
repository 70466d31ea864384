# SPDX-License-Identifier: GPL-3.0-or-later
# A toolchain for arm64 on a machine of another kind: scripts/test-arm64 gives it LANDFALL_SYSROOT, a folder with the arm64 packages
# of Debian 12. Programs that the build runs are started by qemu, which needs no support of the kernel.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES LANDFALL_SYSROOT)
set(CMAKE_SYSROOT ${LANDFALL_SYSROOT})
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static;-L;${LANDFALL_SYSROOT})
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)  # of an ABI before GCC 10
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${LANDFALL_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${LANDFALL_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${LANDFALL_SYSROOT}/usr/share/pkgconfig)
# FindHDF5 asks the compiler wrapper of this machine, which knows only its own folders.
foreach(name hdf5 hdf5_hl)
  set(HDF5_C_LIBRARY_${name} ${LANDFALL_SYSROOT}/usr/lib/aarch64-linux-gnu/hdf5/serial/lib${name}.so CACHE FILEPATH "")
endforeach()
# The package's name, and where dpkg-shlibdeps finds libraries.
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS
    ${LANDFALL_SYSROOT}/lib/aarch64-linux-gnu ${LANDFALL_SYSROOT}/usr/lib/aarch64-linux-gnu)
