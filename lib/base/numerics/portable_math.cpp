// SPDX-License-Identifier: GPL-3.0-or-later
// The polynomials are Chebyshev fits of 40 digits, coefficients from the highest power down. Decisions: D430
#include "base/numerics/portable_math.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "base/numerics/exact_arithmetic.h"
#include "base/numerics/non_finite.h"

namespace landfall::portable {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalfPi = kPi / 2;
constexpr double kHalfPiRest = 0x1.1a62633145c07p-54;
constexpr double kLn2High = 0x1.62e42feep-1;  // times an exponent this is exact
constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
/// A sum with it is rounded to an integer, for |x| < 2^51.
constexpr double kRounder = 0x1.8p52;

double rounded(double x) { return (x + kRounder) - kRounder; }

template <std::size_t N>
double polynomial(const std::array<double, N>& coefficients, double x) {
  double sum = coefficients[0];
  for (std::size_t i = 1; i < N; ++i) sum = sum * x + coefficients[i];
  return sum;
}

// Sine and cosine.

/// x less n quarter turns, in [-pi/4, pi/4] and a little beyond.
struct Quadrant {
  unsigned quarter;
  ExactPair angle;
};

Quadrant quadrant_of(double x) {
  constexpr double kMaxAngle = 5e8;
  // pi/2 in parts whose products with a quarter's number are exact.
  constexpr std::array kParts = {0x1.921fb4p+0, 0x1.4442dp-24, 0x1.846988p-48, 0x1.8cc51701b839ap-72};
  if (std::abs(x) > kMaxAngle) x = std::fmod(x, 2 * kPi);
  const double n = rounded(x * (2 / kPi));
  const ExactPair first = exact_sum(x - n * kParts[0], -(n * kParts[1]));
  const ExactPair second = exact_sum(first.value, -(n * kParts[2]));
  const ExactPair angle = exact_sum(second.value, (first.rest + second.rest) - n * kParts[3]);
  return {static_cast<unsigned>(static_cast<std::int64_t>(n) & 3), angle};
}

double sine_near_0(const ExactPair& x) {
  constexpr std::array kSine = {0x1.5e0af186af739p-33,  -0x1.ae600a926c89ap-26, 0x1.71de37961e4c6p-19,
                                -0x1.a01a019e8357dp-13, 0x1.1111111110bb1p-7,   -0x1.5555555555555p-3};
  const double z = x.value * x.value;
  return x.value + (x.value * z * polynomial(kSine, z) + x.rest * (1 - z / 2));
}

double cosine_near_0(const ExactPair& x) {
  constexpr std::array kCosine = {-0x1.907d7aebd5e3dp-37, 0x1.1eeb68b109173p-29,  -0x1.27e4fa17a41b4p-22,
                                  0x1.a01a019f4e867p-16,  -0x1.6c16c16c16966p-10, 0x1.5555555555555p-5};
  const double z = x.value * x.value;
  const double one_less = 1 - z / 2;
  return one_less + (((1 - one_less) - z / 2) + (z * z * polynomial(kCosine, z) - x.value * x.rest));
}

double sine_of(const ExactPair& x, unsigned quarter) {
  const double value = quarter % 2 == 0 ? sine_near_0(x) : cosine_near_0(x);
  return quarter < 2 ? value : -value;
}

// Arc tangent.

double arc_tangent_near_0(double t) {
  constexpr std::array kTangent = {-0x1.03f90ee84c16cp-4, 0x1.3acaaa661b479p-4,  -0x1.745c4c44608ddp-4,
                                   0x1.c71c70a4cdd24p-4,  -0x1.249249242f53fp-3, 0x1.9999999999805p-3,
                                   -0x1.5555555555555p-2};
  return t * (t * t) * polynomial(kTangent, t * t);
}

/// For 0 <= x <= 1, from the nearest of 0, 1/4, 1/2, 3/4, 1.
double arc_tangent_to_1(double x) {
  constexpr std::array kKnown = {ExactPair{0, 0}, ExactPair{0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                 ExactPair{0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                 ExactPair{0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                 ExactPair{0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};
  const auto nearest = static_cast<std::size_t>(4 * x + 0.5);
  if (nearest == 0) return x + arc_tangent_near_0(x);
  const double from = static_cast<double>(nearest) / 4;
  const double t = (x - from) / (1 + x * from);
  return kKnown.at(nearest).value + (t + (kKnown.at(nearest).rest + arc_tangent_near_0(t)));
}

// Exponential and logarithm.

/// 2^exponent as a product of two, so that results below the normal numbers are rounded once.
double scaled(double value, int exponent) {
  const auto power = [](int e) { return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52U); };
  const int half = exponent / 2;
  return value * power(half) * power(exponent - half);
}

/// e^x = 2^exponent (1 + rest), |rest| < 0.42.
struct Exponential {
  int exponent;
  double rest;
};

/// e^(high + low), |high| < 746.
Exponential exponential_of(const ExactPair& x) {
  constexpr std::array kExponential = {0x1.af390ba7e6f47p-26, 0x1.2891d4ffbb0f9p-22, 0x1.71de0d85293b8p-19,
                                       0x1.a019b8ca26fcfp-16, 0x1.a01a01a7cebcdp-13, 0x1.6c16c1789d1d7p-10,
                                       0x1.11111111109a6p-7,  0x1.5555555553d37p-5,  0x1.5555555555556p-3,
                                       0x1.0000000000001p-1};
  const double k = rounded(x.value * (1 / std::numbers::ln2));
  const ExactPair r = exact_sum(x.value - k * kLn2High, x.rest - k * kLn2Low);
  return {static_cast<int>(k), r.value + (r.value * r.value * polynomial(kExponential, r.value) + r.rest)};
}

double exp_of(const ExactPair& x) {
  if (std::isnan(x.value)) return x.value;
  if (x.value > 709.79) return kInfinity;
  if (x.value < -745.2) return 0;
  const Exponential found = exponential_of(x);
  return scaled(1 + found.rest, found.exponent);
}

/// x = 2^exponent mantissa of a positive finite x, the mantissa in [sqrt(1/2), sqrt(2)).
struct Parts {
  double exponent;
  double mantissa;
};

Parts parts_of(double x) {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);
  if (mantissa < std::numbers::sqrt2 / 2) {
    mantissa *= 2;
    --exponent;
  }
  return {static_cast<double>(exponent), mantissa};
}

/// log x of a positive finite x, with about 10 bits more than a double. With s = (m - 1) / (m + 1), log m is
/// 2 artanh s.
ExactPair log_of(double x) {
  constexpr std::array kArtanh = {0x1.0c1263e1bac13p-3, 0x1.0fbd2bafa02d6p-3, 0x1.3b1c42e3df02cp-3,
                                  0x1.745cf8c4c7bcap-3, 0x1.c71c7201f207cp-3, 0x1.2492492476765p-2,
                                  0x1.9999999999a3ap-2, 0x1.5555555555555p-1};
  const auto [k, m] = parts_of(x);
  const double f = m - 1;
  const ExactPair below = exact_sum(2, f);
  const double s = f / below.value;
  const ExactPair product = exact_product(s, below.value);
  const double s_low = (((f - product.value) - product.rest) - s * below.rest) / below.value;
  const double z = s * s;
  const ExactPair whole = exact_sum(k * kLn2High, 2 * s);
  const double rest = whole.rest + ((s * z * polynomial(kArtanh, z) + 2 * s_low) + k * kLn2Low);
  return exact_sum(whole.value, rest);
}

// Fits on an interval: the variable is 1 and -1 at its ends.

template <std::size_t N>
struct Fit {
  double middle;
  double over_half;
  std::array<double, N> coefficients;
  [[nodiscard]] double at(double x) const { return polynomial(coefficients, (x - middle) * over_half); }
};

/// E_1(x) + log x for x in [0, 1].
constexpr Fit<15> kIntegralTo1 = {
    0x1p-1,
    0x1p+1,
    {-0x1.225f6747f23a2p-55, 0x1.1269fb4e6e147p-50, -0x1.e296619b3a3e1p-46, 0x1.8c26e90441e5p-41,
     -0x1.2cc4b1914fcd1p-36, 0x1.a3b4f3238fdc9p-32, -0x1.0b223968f882fp-27, 0x1.33836e3db0d3bp-23,
     -0x1.3cdd41b938125p-19, 0x1.20c319a556088p-15, -0x1.cb2d66607747p-12, 0x1.3a4dba1c75d4bp-8,
     -0x1.7179c2ac4f788p-5, 0x1.92e9a0720d3ecp-2, -0x1.11262ba8bb9b6p-3}};
/// x e^x E_2(x) for 1/x in [1/3, 1], [1/8, 1/3] and [0, 1/8].
constexpr Fit<21> kIntegralTo3 = {
    0x1.5555555555555p-1, 0x1.8p+1, {0x1.b43ebde4355dap-32,  -0x1.17a1cff7a688fp-30, 0x1.28ee289084eadp-31,
                                     -0x1.92754ac313a04p-30, 0x1.2a68336b04e0ep-27,  -0x1.8b8017d7af966p-26,
                                     0x1.ddebb05842bd8p-25,  -0x1.440d87dde7c2ep-23, 0x1.c0e99ffe5038cp-22,
                                     -0x1.36db6bf083b97p-20, 0x1.b3cda034e32fbp-19,  -0x1.3634b840954f9p-17,
                                     0x1.c10da45900628p-16,  -0x1.4b5df035e163fp-14, 0x1.f4569882cb5b1p-13,
                                     -0x1.8443377c03b9bp-11, 0x1.37b5f86a849ebp-9,   -0x1.0566dc909dcf8p-7,
                                     0x1.d0f94fa2017c1p-6,   -0x1.c2843542430bfp-4,  0x1.f73775529bdf2p-2}};
constexpr Fit<18> kIntegralTo8 = {
    0x1.d555555555555p-3,
    0x1.3333333333333p+3,
    {-0x1.0cfbae27129b4p-37, 0x1.d9abb565058d4p-36, -0x1.0f3a9a021555ep-34, 0x1.f22d392723dd5p-33,
     -0x1.f478f88701dafp-31, 0x1.d920f805e74c1p-29, -0x1.c60062ae0fe01p-27, 0x1.bfde645b2a49fp-25,
     -0x1.c520dba350e4fp-23, 0x1.d7aec648f018p-21, -0x1.fb8f445a9cde2p-19, 0x1.1bf336604c18cp-16,
     -0x1.4cee5452ba864p-14, 0x1.9d8066bf3f258p-12, -0x1.144f7840d49e7p-9, 0x1.972f84921e8efp-7,
     -0x1.5908cd5a9be34p-4, 0x1.6dff024a9702dp-1}};
constexpr Fit<20> kIntegralBeyond = {
    0x1p-4,
    0x1p+4,
    {-0x1.92e45cfa4fb4cp-34, 0x1.c9bd9466ca769p-33, -0x1.af11c0efe30fbp-36, 0x1.c189e65bea35bp-34,
     -0x1.6e2a19bfb5p-30,    0x1.d1eb4ce6ad083p-29, -0x1.0a6e1ab96e987p-27, 0x1.7282ae7429106p-26,
     -0x1.0e38c27789d64p-24, 0x1.932bf95dc3e02p-23, -0x1.3a2955eee987dp-21, 0x1.01922fb2e14d1p-19,
     -0x1.bf432b09dcc16p-18, 0x1.9f10b16509851p-16, -0x1.a0c23b50e65d1p-14, 0x1.cc46e544c7f64p-12,
     -0x1.1e28033127873p-9,  0x1.9ed9cd9f48eadp-7,  -0x1.7356670dcd0b7p-4,  0x1.c9b0999ac3339p-1}};
/// The quantile of 0.5 + q over q, for q^2 in [0, 0.09].
constexpr Fit<17> kQuantileInside = {
    0x1.70a3d70a3d70ap-5,
    0x1.638e38e38e38ep+4,
    {0x1.9f1dc7b934b7p-40, 0x1.fa029d1fe875cp-38, 0x1.fd5c28ebbfbb9p-36, 0x1.3a2787bf7ba84p-33,
     0x1.8bffdf6b17fa9p-31, 0x1.ef0453affe50bp-29, 0x1.37eccd755e34ep-26, 0x1.8d7afe723bd9ap-24,
     0x1.0088bacee3754p-21, 0x1.508767805d58dp-19, 0x1.c2cde7a7af41ap-17, 0x1.368e8808474a2p-14,
     0x1.bd4252042e4f4p-12, 0x1.53248309f98abp-9, 0x1.1e788bbcff9d8p-6, 0x1.2c7d89b6787c2p-3,
     0x1.51ad06a79dc3bp+1}};
/// The quantile of exp(-s^2) for s in [1.26, 2.2], [2.2, 4.5] and [4.5, 8.7].
constexpr Fit<20> kQuantileNear = {
    0x1.bae147ae147aep+0,
    0x1.10572620ae4c4p+1,
    {-0x1.af8a22263fcb5p-41, 0x1.a55cb839d24dbp-39, -0x1.15f3754de2a47p-37, 0x1.1245752ff60b9p-35,
     -0x1.21cd472da8161p-33, 0x1.207093577c217p-31, -0x1.1f778349b4eebp-29, 0x1.21d4cce18d672p-27,
     -0x1.26a40b0d56c27p-25, 0x1.2e5a80101f6edp-23, -0x1.39dcd833ee474p-21, 0x1.4a646e68ca796p-19,
     -0x1.61be5ed3eb711p-17, 0x1.829cac0e2927bp-15, -0x1.b11d6c8c7b67cp-13, 0x1.f3d163e76dc37p-11,
     -0x1.2b0c7d0776371p-8,  0x1.7768fbf307603p-6,  -0x1.93e1c8606ad6ap-1,  -0x1.a4bb1d7c07a0bp+0}};
constexpr Fit<20> kQuantileFar = {
    0x1.acccccccccccdp+1,
    0x1.bd37a6f4de9bdp-1,
    {-0x1.83566913f77f8p-34, 0x1.2b0c850935154p-32, -0x1.ba5c0c5d83a6bp-32, 0x1.5a7247380dc5fp-30,
     -0x1.50f19df48f776p-28, 0x1.095ebe8d69bf5p-26, -0x1.9aeb07def6a98p-25, 0x1.47c934be5c27ap-23,
     -0x1.07c7e3f78d6d8p-21, 0x1.ab3f8c575893ep-20, -0x1.5d108889f1e38p-18, 0x1.2001ab5e2050bp-16,
     -0x1.e068f2172414ap-15, 0x1.9588ffdaedaa1p-13, -0x1.5b20279dce6e3p-11, 0x1.2e363b802287dp-9,
     -0x1.0d1a44a9d302dp-7,  0x1.efac9ebe230e4p-6,  -0x1.bea4d8d236a3fp+0,  -0x1.0cc6135098025p+2}};
constexpr Fit<20> kQuantileFarther = {
    0x1.a666666666666p+2,
    0x1.e79e79e79e79ep-2,
    {-0x1.729ae447d018fp-36, 0x1.348e33d87dcaep-34, -0x1.1b821b1d01addp-33, 0x1.dcb3855d64379p-32,
     -0x1.cf870a2d62e56p-30, 0x1.87521dc1069bbp-28, -0x1.46ee52388b8fap-26, 0x1.15f6f65f4576ep-24,
     -0x1.dad820cf26d79p-23, 0x1.96e3ec79b32bbp-21, -0x1.5e3c0251697b6p-19, 0x1.2f0a411f04ecbp-17,
     -0x1.07ce52acf017bp-15, 0x1.ceba2e0fb0e7dp-14, -0x1.99ad6d81aa7fp-12,  0x1.6f532fb59e634p-10,
     -0x1.4f5581e9cc5f5p-8,  0x1.3ad5c143a324bp-6,  -0x1.85dc09893545p+1,   -0x1.1fc2aeee4279bp+3}};

/// The logarithm of 0, infinity, negative numbers and NaN.
double log_of_limit(double x) { return x == 0 ? -kInfinity : x == kInfinity ? kInfinity : kNan; }

bool is_positive_and_finite(double x) { return x > 0 && x < kInfinity; }

}  // namespace

double sin(double x) {
  if (!std::isfinite(x)) return kNan;
  const auto [quarter, angle] = quadrant_of(x);
  return x == 0 ? x : sine_of(angle, quarter);
}

double cos(double x) {
  if (!std::isfinite(x)) return kNan;
  const auto [quarter, angle] = quadrant_of(x);
  return sine_of(angle, (quarter + 1) % 4);
}

double tan(double x) { return sin(x) / cos(x); }

double asin(double x) { return atan2(x, std::sqrt((1 - x) * (1 + x))); }

double acos(double x) { return 2 * atan2(std::sqrt(1 - x), std::sqrt(1 + x)); }

double atan(double x) { return atan2(x, 1); }

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNan;
  const double a = std::abs(x);
  const double b = std::abs(y);
  double angle = 0;
  if (b > a) {
    const double from_y = arc_tangent_to_1(a / b);
    angle = std::signbit(x) ? kHalfPi + (from_y + kHalfPiRest) : kHalfPi - (from_y - kHalfPiRest);
  } else {
    if (b > 0) angle = arc_tangent_to_1(b / a);
    if (std::signbit(x)) angle = kPi - (angle - 2 * kHalfPiRest);
  }
  return std::copysign(angle, y);
}

double exp(double x) { return exp_of({x, 0}); }

double exp2(double x) {
  if (std::isnan(x)) return x;
  if (x >= 1024) return kInfinity;
  if (x < -1076) return 0;
  constexpr double kLn2Rest = 0x1.abc9e3b39803fp-56;
  const double k = rounded(x);
  const ExactPair log = exact_product(x - k, std::numbers::ln2);
  const Exponential found = exponential_of({log.value, log.rest + (x - k) * kLn2Rest});
  return scaled(1 + found.rest, static_cast<int>(k) + found.exponent);
}

double expm1(double x) {
  if (!(std::abs(x) < 36)) return exp(x) - 1;
  const Exponential found = exponential_of({x, 0});
  const double power = scaled(1, found.exponent);
  return x == 0 ? x : power * found.rest + (power - 1);
}

double log(double x) {
  if (!is_positive_and_finite(x)) return log_of_limit(x);
  return log_of(x).value;
}

double log1p(double x) {
  const double sum = 1 + x;
  if (!is_positive_and_finite(sum)) return log_of_limit(sum);
  if (sum == 1) return x;
  const ExactPair exact = exact_sum(1, x);
  const ExactPair found = log_of(exact.value);
  return found.value + (found.rest + exact.rest / exact.value);
}

double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (!(x >= 0) || std::isnan(y)) return kNan;
  if (x == 0 || x == kInfinity) return (x == 0) == (y > 0) ? 0 : kInfinity;
  const ExactPair log = log_of(x);
  if (std::abs(log.value * y) > 746) return (x > 1) == (y > 0) ? kInfinity : 0;
  const ExactPair whole = exact_product(log.value, y);
  return exp_of({whole.value, whole.rest + log.rest * y});
}

double cosh(double x) {
  const double e = exp(std::abs(x));
  return e / 2 + 0.5 / e;
}

double tanh(double x) {
  if (std::abs(x) > 20) return std::copysign(1, x);
  const double e = expm1(2 * x);
  return e / (e + 2);
}

double hypot(double x, double y) { return std::sqrt(x * x + y * y); }

/// t exp(P(u) - x^2) with t = 2 / (2 + x), and u in [-1, 1] for t in [2/9.5, 1].
double erfc(double x) {
  constexpr std::array kLog = {
      0x1.184e367da78f8p-33,  0x1.f2496d038944dp-33,  -0x1.2a4e9c63c0772p-29, 0x1.8dd096e90f42dp-32,
      0x1.1133719c81177p-26,  -0x1.ed624f82a68a7p-26, -0x1.9e039b13308bdp-25, 0x1.1ef80839017bep-22,
      -0x1.ad595b394266ep-23, -0x1.568f1fdb675ecp-20, 0x1.d16aa2a1a067cp-19,  0x1.fd2a51fb0b611p-20,
      -0x1.976fa5daa34e4p-16, 0x1.b60b312d7acecp-16,  0x1.dd0bc74d3f031p-14,  -0x1.56823ad8b947dp-12,
      -0x1.67c4d1a30b0acp-12, 0x1.6749b0ebaf6c9p-9,   -0x1.111cbc738dfcep-14, -0x1.9c3337d0d7b91p-6,
      0x1.45d822e7224ddp-7,   0x1.1550599de0a1bp-1,   -0x1.0e9cc741901d7p-1};
  if (x < 0) return 2 - erfc(-x);
  if (x > 27) return 0;
  const double t = 2 / (2 + x);
  return t * exp(polynomial(kLog, (t - 0x1.35e50d79435e5p-1) * 0x1.4444444444444p+1) - x * x);
}

/// Stirling's series at x + 12, which is above 12.
double gamma(double x) {
  double product = 1;
  for (int i = 0; i < 12; ++i) product *= x + i;
  const double z = x + 12;
  const double inverse = 1 / (z * z);
  const double series =
      (1.0 / 12 - (1.0 / 360 - (1.0 / 1260 - (1.0 / 1680 - inverse / 1188) * inverse) * inverse) * inverse) /
      z;
  return std::sqrt(2 * kPi / z) * pow(z / std::numbers::e, z) * exp(series) / product;
}

double exponential_integral_2(double x) {
  if (!(x > 0)) return x == 0 ? 1 : kNan;
  if (x <= 1) return exp(-x) - x * (kIntegralTo1.at(x) - log(x));
  const double inverse = 1 / x;
  const double over = x <= 3   ? kIntegralTo3.at(inverse)
                      : x <= 8 ? kIntegralTo8.at(inverse)
                               : kIntegralBeyond.at(inverse);
  return exp(-x) * inverse * over;
}

double normal_quantile(double p) {
  if (!(p >= 1e-32 && p <= 1)) return kNan;
  const double from_middle = p - 0.5;
  if (std::abs(from_middle) <= 0.3) return from_middle * kQuantileInside.at(from_middle * from_middle);
  const double tail = p < 0.5 ? p : 1 - p;
  const double s = std::sqrt(-log(tail));
  const double size = s <= 2.2 ? kQuantileNear.at(s) : s <= 4.5 ? kQuantileFar.at(s) : kQuantileFarther.at(s);
  return p < 0.5 ? size : tail == 0 ? kInfinity : -size;
}

}  // namespace landfall::portable
