// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The mutated sources' own warnings are no errors.
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wnarrowing"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wparentheses"
#pragma GCC diagnostic ignored "-Wunused-variable"
#pragma GCC diagnostic ignored "-Wunused-value"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#pragma GCC diagnostic ignored "-Wunused-but-set-parameter"
#pragma GCC diagnostic ignored "-Wunused-result"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wreturn-type"
#pragma GCC diagnostic ignored "-Wint-in-bool-context"
#pragma GCC diagnostic ignored "-Wbool-compare"
#pragma GCC diagnostic ignored "-Wbool-operation"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wlogical-op"
#pragma GCC diagnostic ignored "-Wtype-limits"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Warray-bounds"
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#pragma GCC diagnostic ignored "-Wdangling-else"
#pragma GCC diagnostic ignored "-Wmisleading-indentation"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wpsabi"
#pragma GCC diagnostic warning "-Wdeprecated-declarations"

#include <concepts>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <type_traits>
#include <utility>

/// Mutant schemata: schema.py writes each mutation point of the libraries as a call of one of these, so that
/// one build holds all mutants and the environment chooses one at the start of a program:
///   LANDFALL_MUTANT=n         mutant n is on
///   LANDFALL_MUTANT_TRACE=f   none is on; the mutants that were reached are appended to the file f, one per
///   line
/// In constant expressions no mutant is ever on. Where the types do not allow a mutant, the compiler says
/// that `impossible<n>` is deprecated.
namespace landfall_mutant {

constexpr std::size_t kMax = 1U << 15U;
enum Flag : unsigned char { kOff = 0, kOn = 1, kTraced = 2, kReached = 3 };

inline unsigned char flags[kMax] = {};

inline void write_trace() {
  std::FILE* const file = std::fopen(std::getenv("LANDFALL_MUTANT_TRACE"), "a");
  if (file == nullptr) return;
  for (std::size_t id = 0; id < kMax; ++id)
    if (flags[id] == kReached) std::fprintf(file, "%zu\n", id);
  std::fclose(file);
}

inline const bool started = [] {
  if (std::getenv("LANDFALL_MUTANT_TRACE") != nullptr) {
    for (unsigned char& flag : flags) flag = kTraced;
    std::atexit(write_trace);
  } else if (const char* const id = std::getenv("LANDFALL_MUTANT")) {
    flags[std::strtoul(id, nullptr, 10) % kMax] = kOn;
  }
  return true;
}();

/// True where mutant `id` is on. Threads may race for a trace; they write the same.
inline bool switched(std::size_t id) {
  if (flags[id] == kTraced) flags[id] = kReached;
  return flags[id] == kOn;
}

template <int id>
constexpr bool on() {
  if (std::is_constant_evaluated()) return false;
  return __builtin_expect(flags[id] != kOff, 0) && switched(id);
}

template <int id>
[[deprecated]] constexpr void impossible() {}

template <class T>
concept Eigenlike = requires {
  typename std::remove_cvref_t<T>::PlainObject;
};

/// The type that holds an expression's value: an expression template is evaluated.
template <class T>
struct Held {
  using type = std::remove_cvref_t<T>;
};
template <Eigenlike T>
struct Held<T> {
  using type = typename std::remove_cvref_t<T>::PlainObject;
};
template <class T>
using Holder = typename Held<T>::type;

#define LANDFALL_MUTANT_BINARY(name, usual, mutated)                \
  template <int id, class A, class B>                               \
  constexpr auto name(A&& a, B&& b) {                               \
    using Result = Holder<decltype(a usual b)>;                     \
    if constexpr (requires { static_cast<Result>(a mutated b); }) { \
      if (on<id>()) return static_cast<Result>(a mutated b);        \
    } else {                                                        \
      impossible<id>();                                             \
    }                                                               \
    return static_cast<Result>(a usual b);                          \
  }
LANDFALL_MUTANT_BINARY(add, +, -)
LANDFALL_MUTANT_BINARY(subtract, -, +)
LANDFALL_MUTANT_BINARY(divide, /, *)
LANDFALL_MUTANT_BINARY(remainder, %, *)
LANDFALL_MUTANT_BINARY(shift_left, <<, >>)
LANDFALL_MUTANT_BINARY(shift_right, >>, <<)
LANDFALL_MUTANT_BINARY(bit_and, &, |)
LANDFALL_MUTANT_BINARY(bit_or, |, &)
LANDFALL_MUTANT_BINARY(bit_xor, ^, &)
LANDFALL_MUTANT_BINARY(equal, ==, !=)
LANDFALL_MUTANT_BINARY(unequal, !=, ==)

/// A quotient instead of a product; of matrices, the product with the transpose.
template <int id, class A, class B>
constexpr auto multiply(A&& a, B&& b) {
  using Result = Holder<decltype(a * b)>;
  if constexpr (Eigenlike<A> && Eigenlike<B>) {
    if constexpr (requires { a.transpose() * b; }) {
      if (on<id>()) return static_cast<Result>(a.transpose() * b);
    } else {
      impossible<id>();
    }
  } else if constexpr (requires { static_cast<Result>(a / b); }) {
    if (on<id>()) return static_cast<Result>(a / b);
  } else if constexpr (requires { static_cast<Result>(b / a); }) {
    if (on<id>()) return static_cast<Result>(b / a);
  } else {
    impossible<id>();
  }
  return static_cast<Result>(a * b);
}

/// Two mutants: the border moves over (id), the comparison is negated (id + 1).
#define LANDFALL_MUTANT_ORDER(name, usual, border, negated) \
  template <int id, class A, class B>                       \
  constexpr auto name(A&& a, B&& b) {                       \
    if (on<id>()) return a border b;                        \
    if (on<id + 1>()) return a negated b;                   \
    return a usual b;                                       \
  }
LANDFALL_MUTANT_ORDER(less, <, <=, >=)
LANDFALL_MUTANT_ORDER(less_equal, <=, <, >)
LANDFALL_MUTANT_ORDER(greater, >, >=, <=)
LANDFALL_MUTANT_ORDER(greater_equal, >=, >, <)

#define LANDFALL_MUTANT_ASSIGNMENT(name, usual, mutated) \
  template <int id, class A, class B>                    \
  constexpr decltype(auto) name(A&& a, B&& b) {          \
    if constexpr (requires { a mutated b; }) {           \
      if (on<id>()) return a mutated b;                  \
    } else {                                             \
      impossible<id>();                                  \
    }                                                    \
    return a usual b;                                    \
  }
LANDFALL_MUTANT_ASSIGNMENT(add_to, +=, -=)
LANDFALL_MUTANT_ASSIGNMENT(subtract_from, -=, +=)
LANDFALL_MUTANT_ASSIGNMENT(multiply_by, *=, /=)
LANDFALL_MUTANT_ASSIGNMENT(divide_by, /=, *=)
LANDFALL_MUTANT_ASSIGNMENT(and_into, &=, |=)
LANDFALL_MUTANT_ASSIGNMENT(or_into, |=, &=)
LANDFALL_MUTANT_ASSIGNMENT(xor_into, ^=, |=)

/// a && b is gate(a) ? b : on(); a || b is gate(a) ? on() || ... : see schema.py. The other operator where
/// on.
template <int id, class A>
constexpr bool gate(A&& a) {
  return static_cast<bool>(a) != on<id>();
}

template <int id, class A>
constexpr bool condition(A&& a) {
  return static_cast<bool>(a) != on<id>();
}

template <int id, class A>
constexpr auto minus(A&& a) {
  using Result = Holder<decltype(-a)>;
  if (on<id>()) return static_cast<Result>(a);
  return static_cast<Result>(-a);
}

template <class T>
constexpr T other_value(T value) {
  if constexpr (std::same_as<T, bool>)
    return !value;
  else if constexpr (std::integral<T>)
    return static_cast<T>(value == 1 ? 0 : value + 1);
  else
    return value == 0 ? T{1} : -value;
}

/// A literal or a named constant. 0 becomes 1 and 1 becomes 0; other whole numbers grow by 1, others change
/// sign.
template <int id, class T>
constexpr T value(T constant) {
  return on<id>() ? other_value(constant) : constant;
}
/// The same where the language would rather fold the value: in what was a constexpr array.
template <int id, class T>
T value_in_array(T constant) {
  return __builtin_expect(flags[id] != kOff, 0) && switched(id) ? other_value(constant) : constant;
}

/// A returned value: its negation for a truth value, 0 for a number (1 for 0), what T{} is for others. It is
/// always inlined, because a function for another instruction set would return vectors in another place.
template <int id, class T>
[[gnu::always_inline]] constexpr T returned(T value) {
  if constexpr (std::same_as<T, bool>) {
    if (on<id>()) return !value;
  } else if constexpr (std::is_arithmetic_v<T>) {
    if (on<id>()) return value == 0 ? T{1} : T{0};
  } else if constexpr (requires { value.setZero(); }) {
    if (on<id>()) value.setZero();
  } else if constexpr (requires { value.coeffs().setZero(); }) {
    if (on<id>()) value.coeffs().setZero();
  } else if constexpr (requires { T{}; }) {
    if (on<id>()) return T{};
  } else {
    impossible<id>();
  }
  return value;
}

#define LANDFALL_MUTANT_EXTREME(name, other, order)                        \
  template <int id, class T>                                               \
  constexpr T name##_as(const T& a, const T& b) {                          \
    return (b order a) != on<id>() ? b : a;                                \
  }                                                                        \
  template <int id, class T>                                               \
  constexpr T name(const T& a, const T& b) {                               \
    return (b order a) != on<id>() ? b : a;                                \
  }                                                                        \
  template <int id, class T>                                               \
  constexpr T name(std::initializer_list<T> values) {                      \
    T found = *values.begin();                                             \
    for (const T& value : values)                                          \
      if (on<id>() ? found order value : value order found) found = value; \
    return found;                                                          \
  }
LANDFALL_MUTANT_EXTREME(min, max, <)
LANDFALL_MUTANT_EXTREME(max, min, >)

}  // namespace landfall_mutant
