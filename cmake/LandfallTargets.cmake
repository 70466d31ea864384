# SPDX-License-Identifier: GPL-3.0-or-later
# How every target of this project is built: one function per kind of target.
#
# Release builds are hardened like Debian's: stack protector, fortified C functions, all symbols bound at start. No
# number depends on it.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

add_library(landfall_flags INTERFACE)
target_compile_options(landfall_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast
  # A fused multiply-add rounds once where two operations round twice: without this the result would depend
  # on the compiler and the target.
  -ffp-contract=off
  # g++ 12 sees overlapping copies inside std::string's own operator+ where there are none (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<BOOL:${LANDFALL_WERROR}>:-Werror>)
# The options by which Debian hardens its packages (dpkg-buildflags with hardening=+all); no number depends on it. The prefix map
# keeps the folder of the build out of the programs.
target_compile_options(landfall_flags INTERFACE
  $<$<CONFIG:Release>:-fstack-protector-strong>
  $<$<CONFIG:Release>:-U_FORTIFY_SOURCE>
  $<$<CONFIG:Release>:-D_FORTIFY_SOURCE=2>
  $<$<CONFIG:Release>:-ffile-prefix-map=${CMAKE_SOURCE_DIR}=.>)
target_link_options(landfall_flags INTERFACE $<$<CONFIG:Release>:LINKER:-z,relro,-z,now>)
target_include_directories(landfall_flags INTERFACE ${CMAKE_SOURCE_DIR}/lib)
# Philox uses none of the intrinsics of x86 that Random123 would include: half a second of each unit.
target_compile_definitions(landfall_flags INTERFACE R123_USE_SSE=0 R123_USE_X86INTRIN_H=0)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  target_include_directories(landfall_flags BEFORE INTERFACE ${CMAKE_SOURCE_DIR}/cmake/arm64)
  # The instructions of Highway's functions, which g++ 12 inlines only into functions with the same; the constructors that it makes
  # itself have those of the command line.
  target_compile_options(landfall_flags INTERFACE -march=armv8-a+crypto)
endif()
target_link_libraries(landfall_flags INTERFACE Threads::Threads)
set(landfall_instrumentation)  # what whoever links instrumented objects must be linked with
if(LANDFALL_SANITIZE)
  target_compile_options(landfall_flags INTERFACE -fsanitize=${LANDFALL_SANITIZE} -fno-sanitize-recover=all
                         -fno-omit-frame-pointer)
  target_compile_definitions(landfall_flags INTERFACE LANDFALL_SANITIZED)
  list(APPEND landfall_instrumentation -fsanitize=${LANDFALL_SANITIZE})
endif()
if(LANDFALL_COVERAGE)
  target_compile_options(landfall_flags INTERFACE --coverage -fprofile-update=atomic)
  list(APPEND landfall_instrumentation --coverage)
endif()
target_link_options(landfall_flags INTERFACE ${landfall_instrumentation})

# landfall_precompiled(name HEADERS <a> ... LINKS ...): headers that many units of the libraries include, parsed once. A static
# library, because a precompiled header fits only units that are compiled for the same kind of target.
# CMAKE_DISABLE_PRECOMPILE_HEADERS=ON does without, and LANDFALL_UNITY, of whose few units it would not be worth the time.
function(landfall_precompiled name)
  cmake_parse_arguments(arg "" "" "HEADERS;LINKS" ${ARGN})
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/precompiled_${name}.cpp CONTENT "extern int landfall_${name};\n")
  add_library(precompiled_${name} STATIC ${CMAKE_CURRENT_BINARY_DIR}/precompiled_${name}.cpp)
  target_link_libraries(precompiled_${name} PRIVATE landfall_flags ${arg_LINKS})
  target_precompile_headers(precompiled_${name} PRIVATE ${arg_HEADERS})
endfunction()

# landfall_uses_precompiled_strings(target): in a precompiled header g++ 12 forgets that std::string is of a system header, and
# shows more of GCC bug 105651. Builds without precompiled headers keep these warnings.
function(landfall_uses_precompiled_strings target)
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>
                                             $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overread>
                                             $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>)
  endif()
endfunction()

# landfall_builds_fast(target): a target without loops that are worth more than the time of its compilation: -Og takes a quarter less of
# it than -O1.
function(landfall_builds_fast target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Og>)
endfunction()

# landfall_unity_groups(target SOURCES a.cpp ... ALONE b.cpp ...): with LANDFALL_UNITY compiles all sources at a time, up to 120 where
# memory is less than 12 GB, or up to 48 where more than four processors share the work.
function(landfall_unity_groups target)
  if(NOT LANDFALL_UNITY)
    return()
  endif()
  cmake_parse_arguments(arg "" "" "SOURCES;ALONE" ${ARGN})
  list(REMOVE_ITEM arg_SOURCES ${arg_ALONE})
  cmake_host_system_information(RESULT processors QUERY NUMBER_OF_LOGICAL_CORES)
  cmake_host_system_information(RESULT memory_mb QUERY TOTAL_PHYSICAL_MEMORY)
  # g++ takes unnamed namespaces of files that another one includes for those of headers. It would take up to a
  # sixteenth of a group's time to free memory: the largest takes 2.5 GB, or all sources of app 4.4 GB.
  set(options -Wno-subobject-linkage --param=ggc-min-expand=1000)
  if(processors GREATER 4)
    set(most 48)
  elseif(memory_mb LESS 12000)
    set(most 120)
  else()
    set(most 10000)
    list(APPEND options --param=ggc-min-heapsize=8000000)
  endif()
  list(LENGTH arg_SOURCES count)
  math(EXPR groups "(${count} + ${most} - 1) / ${most}")
  set(place 0)
  foreach(source IN LISTS arg_SOURCES)
    math(EXPR number "${place} * ${groups} / ${count}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP SOURCES_${number})
    math(EXPR place "${place} + 1")
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  target_compile_options(${target} PRIVATE "$<$<CXX_COMPILER_ID:GNU>:${options}>")
endfunction()

# landfall_kernel_unit(target a.cpp ...): in place of sources of this folder that include themselves once per instruction set, one unit
# that does so and includes them.
function(landfall_kernel_unit target)
  set(unit ${CMAKE_CURRENT_BINARY_DIR}/${target}_kernels.cpp)
  set(again "#undef HWY_TARGET_INCLUDE\n#define HWY_TARGET_INCLUDE \"${unit}\"\n")
  set(text "${again}#include \"base/numerics/lanes-inl.h\"\n")
  foreach(source IN LISTS ARGN)
    string(APPEND text "#include \"${CMAKE_CURRENT_SOURCE_DIR}/${source}\"\n${again}")
  endforeach()
  file(CONFIGURE OUTPUT ${unit} CONTENT "${text}" @ONLY)
  target_sources(${target} PRIVATE ${unit})
  set_source_files_properties(${ARGN} PROPERTIES HEADER_FILE_ONLY ON)
endfunction()

# landfall_generates(target a.h ...): headers under ${CMAKE_BINARY_DIR}/include that a command of this folder makes, before any library is
# compiled. A target that links nothing makes them, for a source of a library would be made after all libraries that it links.
target_include_directories(landfall_flags INTERFACE ${CMAKE_BINARY_DIR}/include)
function(landfall_generates target)
  add_custom_target(${target} DEPENDS ${ARGN})
  set_property(GLOBAL APPEND PROPERTY LANDFALL_GENERATED ${target})
endfunction()

# landfall_library(name [FAST] [APART] FOLDERS folder a.cpp ... [EXCEPT folder b.cpp ...] [WITH name] LINKS landfall::chain ...
#                  [PRIVATE_LINKS ...] [PRECOMPILED name] [ALONE c.cpp ...] [KERNELS d.cpp ...])
# A static library landfall::<name> of all units of the folders and files, but EXCEPT and those of the plugins and libraries before it. FAST:
# landfall_builds_fast. APART: no part of liblandfall.so; another library has its units too, WITH it.
# LANDFALL_UNITY compiles its units together; scripts/check_unity.py finds names that would collide. ALONE: units that include
# themselves once per instruction set, or a header that no other unit shall see. KERNELS: units of the first kind that may be one
# unit, landfall_kernel_unit.
function(landfall_library name)
  cmake_parse_arguments(arg "FAST;APART" "PRECOMPILED;WITH" "FOLDERS;EXCEPT;LINKS;PRIVATE_LINKS;ALONE;KERNELS" ${ARGN})
  foreach(kind FOLDERS EXCEPT)
    set(${kind})
    foreach(place IN LISTS arg_${kind})
      if(place MATCHES "[.]cpp$")
        list(APPEND ${kind} ${place})
      else()
        file(GLOB_RECURSE units CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${place}/*.cpp)
        list(APPEND ${kind} ${units})
      endif()
    endforeach()
  endforeach()
  get_property(taken GLOBAL PROPERTY LANDFALL_TAKEN)
  list(REMOVE_ITEM FOLDERS ${EXCEPT} ${taken})
  set_property(GLOBAL APPEND PROPERTY LANDFALL_TAKEN ${FOLDERS})
  if(arg_WITH)
    get_target_property(others landfall_${arg_WITH} SOURCES)
    list(APPEND FOLDERS ${others})
  endif()
  if(NOT TARGET landfall_${name})
    add_library(landfall_${name} STATIC)
  endif()
  target_sources(landfall_${name} PRIVATE ${FOLDERS})
  get_property(generated GLOBAL PROPERTY LANDFALL_GENERATED)
  add_dependencies(landfall_${name} ${generated})
  add_library(landfall::${name} ALIAS landfall_${name})
  target_link_libraries(landfall_${name} PUBLIC landfall_flags ${arg_LINKS} PRIVATE ${arg_PRIVATE_LINKS})
  if(NOT arg_APART)
    set_property(GLOBAL APPEND PROPERTY LANDFALL_LIBRARIES landfall_${name})
  endif()
  if(arg_PRECOMPILED AND NOT LANDFALL_UNITY)
    target_precompile_headers(landfall_${name} REUSE_FROM precompiled_${arg_PRECOMPILED})
    landfall_uses_precompiled_strings(landfall_${name})
  endif()
  if(arg_FAST)
    landfall_builds_fast(landfall_${name})
  endif()
  landfall_unity_groups(landfall_${name} SOURCES ${FOLDERS} ALONE ${arg_ALONE} ${arg_KERNELS})
  if(arg_KERNELS AND LANDFALL_UNITY)
    landfall_kernel_unit(landfall_${name} ${arg_KERNELS})
  endif()
endfunction()

# landfall_plugin(name SOURCES a.cpp ... LINKS ...): landfall-<name>.so, which a program loads when it needs its libraries. What it calls of
# landfall is exported by liblandfall.so; a symbol that it lacks is an error of the linker, not of the program that loads it.
function(landfall_plugin name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS" ${ARGN})
  set(plugin landfall_${name}_plugin)
  set(objects landfall_${name}_objects)
  add_library(${objects} OBJECT ${arg_SOURCES})
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${CMAKE_SOURCE_DIR}/lib OUTPUT_VARIABLE folder)
  list(TRANSFORM arg_SOURCES PREPEND ${folder}/ OUTPUT_VARIABLE taken)
  set_property(GLOBAL APPEND PROPERTY LANDFALL_TAKEN ${taken})
  get_property(generated GLOBAL PROPERTY LANDFALL_GENERATED)
  add_dependencies(${objects} ${generated})
  landfall_builds_fast(${objects})
  landfall_unity_groups(${objects} SOURCES ${arg_SOURCES})
  target_compile_definitions(${objects} PRIVATE LANDFALL_VERSION="${PROJECT_VERSION}")
  target_link_libraries(${objects} PRIVATE landfall_flags TBB::tbb Eigen3::Eigen ${arg_LINKS})
  set_property(GLOBAL APPEND PROPERTY LANDFALL_EXPORTED_TO $<TARGET_OBJECTS:${objects}>)
  add_library(${plugin} MODULE $<TARGET_OBJECTS:${objects}>)
  target_link_libraries(${plugin} PRIVATE landfall_flags landfall_shared ${arg_LINKS})
  if(NOT LANDFALL_SANITIZE)
    target_link_options(${plugin} PRIVATE LINKER:-z,defs)
  endif()
  set_target_properties(${plugin} PROPERTIES PREFIX "" OUTPUT_NAME landfall-${name} LINKER_LANGUAGE CXX BUILD_WITH_INSTALL_RPATH ON
    INSTALL_RPATH "$ORIGIN" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/landfall)
  install(TARGETS ${plugin} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/landfall)
endfunction()

# landfall_precompiled_tests(): what nearly every unit test includes is parsed once, which is half of such a test's time.
# An executable, for a header goes only with units that are compiled for the same kind of target.
# CMAKE_DISABLE_PRECOMPILE_HEADERS=ON does without.
function(landfall_precompiled_tests)
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/precompiled_tests.cpp CONTENT "int main() {}\n")
  add_executable(precompiled_tests ${CMAKE_CURRENT_BINARY_DIR}/precompiled_tests.cpp)
  target_link_libraries(precompiled_tests PRIVATE landfall_flags Eigen3::Eigen GTest::gmock)
  landfall_builds_fast(precompiled_tests)
  target_precompile_headers(precompiled_tests PRIVATE <gmock/gmock.h> <gtest/gtest.h> <Eigen/Geometry> <Random123/philox.h>)
  set_target_properties(precompiled_tests PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
endfunction()

# landfall_gtest(raster_test LABEL unit SOURCES a_test.cpp ... LINKS landfall::base ... [ALONE b.cpp ...])
# A program of unit tests; ctest runs it as one test, unit_raster.
# With LANDFALL_UNITY up to 48 of its units are compiled together, as those of a library; ALONE: not these.
function(landfall_gtest name)
  cmake_parse_arguments(arg "" "LABEL" "SOURCES;LINKS;ALONE" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE landfall_flags ${arg_LINKS} GTest::gmock GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests/unit)
  landfall_builds_fast(${name})
  target_precompile_headers(${name} REUSE_FROM precompiled_tests)
  landfall_unity_groups(${name} SOURCES ${arg_SOURCES} ALONE ${arg_ALONE})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  string(REGEX REPLACE "_test$" "" test ${arg_LABEL}_${name})
  add_test(NAME ${test} COMMAND ${name})
  set_tests_properties(${test} PROPERTIES LABELS ${arg_LABEL} TIMEOUT 3600)
  landfall_rank_test(${test})
endfunction()
