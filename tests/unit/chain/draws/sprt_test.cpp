// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/draws/sprt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "binomial.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

using enum SprtState;

/// Adds the results until the test stops; 'P' is a pass.
Sprt after(const std::string& results, const SprtParameters& parameters = {}) {
  Sprt sprt(parameters);
  for (const char result : results) sprt.add(result == 'P');
  return sprt;
}

std::string passes(std::size_t count) { return std::string(count, 'P'); }

TEST(Sprt, AcceptsAfter145StraightPasses) {
  EXPECT_EQ(after(passes(144)).state(), running);
  const Sprt stopped = after(passes(145));
  EXPECT_EQ(stopped.state(), accepted);
  EXPECT_EQ(stopped.rate(), (PassRate{145, 145}));
}

TEST(Sprt, EveryFailureCosts54Passes) {  // ln 3 / ln(0.99 / 0.97) = 53.8
  EXPECT_EQ(after("F" + passes(198)).state(), running);
  EXPECT_EQ(after("F" + passes(199)).state(), accepted);
  EXPECT_EQ(after("FF" + passes(251)).state(), running);
  EXPECT_EQ(after("FF" + passes(252)).state(), accepted);
}

TEST(Sprt, RejectsAfterThreeEarlyFailures) {  // 3 ln 3 - 17 ln(0.99 / 0.97) = 2.949 > ln 19 = 2.944
  EXPECT_EQ(after("FF").state(), running);
  EXPECT_EQ(after("FFF").state(), rejected);
  EXPECT_EQ(after("FF" + passes(17) + "F").state(), rejected);
  EXPECT_EQ(after("FF" + passes(18) + "F").state(), running);
  EXPECT_EQ(after("FF" + passes(18) + "FF").state(), rejected);
}

TEST(Sprt, DependsOnCountsNotOnTheirOrder) {
  const std::string early = "FF" + passes(251);
  const std::string late = passes(144) + "F" + passes(53) + "F" + passes(54);
  ASSERT_EQ(early.size(), late.size());
  EXPECT_EQ(after(early).state(), running);
  EXPECT_EQ(after(late).state(), running);
  EXPECT_EQ(after(early + 'P').state(), accepted);
  EXPECT_EQ(after(late + 'P').state(), accepted);
}

// One pass or one failure reaches the limit exactly, but for rounding: ln(p1 / p0) = ln(beta / (1 - alpha)).
TEST(Sprt, StopsOnTheLimit) {
  for (int i = 1; i < 500; ++i) {
    const double error = i / 1000.0;
    const SprtParameters parameters{1 - error, error, error, error};
    ASSERT_EQ(after("P", parameters).state(), accepted) << error;
    ASSERT_EQ(after("F", parameters).state(), rejected) << error;
  }
}

/// The exact distribution of a test's end where draws pass with probability p.
struct End {
  double accepted = 0;
  double rejected = 0;
  double mean_draws = 0;
  double mean_ratio = 0;       ///< of L at the stop
  double mean_likelihood = 0;  ///< of exp(L) at the stop
};

double log_ratio(const SprtParameters& a, const PassRate& rate) {
  return static_cast<double>(rate.k) * std::log(a.p1 / a.p0) +
         static_cast<double>(rate.n - rate.k) * std::log((1 - a.p1) / (1 - a.p0));
}

/// Recursion over the counts after each draw, until `max_draws` or less than 1e-13 is still running.
End end_of(const SprtParameters& parameters, double p, int max_draws = 100000) {
  End end;
  std::map<std::int64_t, std::pair<Sprt, double>> live;  // by the number of passes
  live.emplace(0, std::pair(Sprt(parameters), 1.0));
  double left = 1;
  for (int draw = 0; draw < max_draws && left > 1e-13; ++draw) {
    std::map<std::int64_t, std::pair<Sprt, double>> next;
    left = 0;
    for (const auto& [k, state] : live)
      for (const bool passed : {false, true}) {
        Sprt sprt = state.first;
        sprt.add(passed);
        const double mass = state.second * (passed ? p : 1 - p);
        if (sprt.state() == running) {
          next.emplace(sprt.rate().k, std::pair(sprt, 0.0)).first->second.second += mass;
          left += mass;
          continue;
        }
        (sprt.state() == accepted ? end.accepted : end.rejected) += mass;
        const double ratio = log_ratio(parameters, sprt.rate());
        end.mean_draws += mass * static_cast<double>(sprt.rate().n);
        end.mean_ratio += mass * ratio;
        end.mean_likelihood += mass * std::exp(ratio);
      }
    live = std::move(next);
  }
  return end;
}

const std::vector<SprtParameters> kRules = {
    {},
    {.p0 = 0.99, .p1 = 0.97, .alpha = 0.01, .beta = 0.01},
    {.p0 = 0.99, .p1 = 0.95, .alpha = 0.05, .beta = 0.05},
    {.p0 = 0.999, .p1 = 0.99, .alpha = 0.1, .beta = 0.02},
    {.p0 = 0.9, .p1 = 0.5, .alpha = 0.1, .beta = 0.2},
};

// Computed by another program, which counts failures instead of passes (tests/docs/statistics_test.py).
TEST(Sprt, ErrorRatesAndLengthsByExactRecursion) {
  const struct {
    double p, accepted, mean_draws;
  } cases[] = {
      {0.5, 0, 6.000402450558},
      {0.7, 0, 10.118277154026},
      {0.9, 2.437595e-7, 37.294690535488},
      {0.95, 0.001039826884, 94.929186155411},
      {0.97, 0.050241106572, 230.162148370466},
      {0.99, 0.965346843627, 297.188284198164},
      {0.995, 0.998614756455, 199.072420806346},
      {0.999, 0.999997593812, 153.421232309907},
  };
  for (const auto& expected : cases) {
    const End end = end_of({}, expected.p);
    EXPECT_NEAR(end.accepted, expected.accepted, 1e-11) << expected.p;
    EXPECT_NEAR(end.accepted + end.rejected, 1, 1e-12) << expected.p;
    EXPECT_NEAR(end.mean_draws, expected.mean_draws, 1e-8) << expected.p;
  }
}

TEST(Sprt, KeepsWaldsBoundsOnItsErrorRates) {
  for (const SprtParameters& rule : kRules) {
    const double alpha = end_of(rule, rule.p0).rejected;
    const double beta = end_of(rule, rule.p1).accepted;
    EXPECT_LE(alpha, rule.alpha / (1 - rule.beta)) << rule.p0 << ' ' << rule.p1;
    EXPECT_LE(beta, rule.beta / (1 - rule.alpha)) << rule.p0 << ' ' << rule.p1;
    EXPECT_LE(alpha + beta, rule.alpha + rule.beta) << rule.p0 << ' ' << rule.p1;
    EXPECT_GT(alpha, rule.alpha / 4) << rule.p0 << ' ' << rule.p1;
    EXPECT_GT(beta, rule.beta / 4) << rule.p0 << ' ' << rule.p1;
  }
}

// Wald's two identities, exact for any stopping rule: E L = E n E L_1, and E exp(L) = 1 where p = p0.
TEST(Sprt, KeepsWaldsIdentities) {
  for (const SprtParameters& rule : kRules) {
    for (const double p : kProbabilities) {
      const End end = end_of(rule, p);
      const double step = p * log_ratio(rule, {1, 1}) + (1 - p) * log_ratio(rule, {0, 1});
      EXPECT_NEAR(end.mean_ratio, end.mean_draws * step, 1e-8) << rule.p0 << ' ' << rule.p1 << ' ' << p;
    }
    EXPECT_NEAR(end_of(rule, rule.p0).mean_likelihood, 1, 1e-9) << rule.p0 << ' ' << rule.p1;
  }
}

/// Sums over all sequences of at most `depth` further results, one by one.
void walk(const Sprt& sprt, double mass, double p, int depth, std::map<SprtState, double>& sums) {
  if (sprt.state() != running || depth == 0) {
    sums[sprt.state()] += mass;
    return;
  }
  for (const bool passed : {false, true}) {
    Sprt next = sprt;
    next.add(passed);
    walk(next, mass * (passed ? p : 1 - p), p, depth - 1, sums);
  }
}

TEST(Sprt, RecursionEqualsTheSumOverAllSequences) {
  const SprtParameters& rule = kRules.back();
  for (const double p : kProbabilities) {
    std::map<SprtState, double> sums;
    walk(Sprt(rule), 1, p, 24, sums);
    const End end = end_of(rule, p, 24);
    EXPECT_NEAR(sums[accepted], end.accepted, 1e-13) << p;
    EXPECT_NEAR(sums[rejected], end.rejected, 1e-13) << p;
    EXPECT_NEAR(sums[running], 1 - end.accepted - end.rejected, 1e-13) << p;
  }
}

std::string refusal_of(const std::function<void(SprtParameters&)>& change) {
  SprtParameters parameters;
  change(parameters);
  return refusal([&] { check(parameters); });
}

TEST(SprtParameters, DefaultsAreAccepted) {
  EXPECT_EQ(refusal_of([](auto&) {}), "accepted");
}

TEST(SprtParameters, LieBetweenTheirBounds) {
  for (const double bad : {-1.0, 0.0, 1.0, 2.0, kNan}) {
    EXPECT_THAT(refusal_of([&](auto& a) { a.p0 = bad; }), testing::EndsWith(" is not in (0, 1)"));
    EXPECT_THAT(refusal_of([&](auto& a) { a.p1 = bad; }), testing::EndsWith(" is not in (0, p0)"));
  }
  EXPECT_EQ(refusal_of([](auto& a) { a.p0 = 1.5; }), "p0: 1.5 is not in (0, 1)");
  EXPECT_EQ(refusal_of([](auto& a) { a.p1 = 0.99; }), "p1: 0.99 is not in (0, p0)");
  for (const double bad : {-0.1, 0.0, 0.5, 1.0, kNan}) {
    EXPECT_THAT(refusal_of([&](auto& a) { a.alpha = bad; }), testing::StartsWith("alpha: "));
    EXPECT_THAT(refusal_of([&](auto& a) { a.beta = bad; }), testing::StartsWith("beta: "));
  }
  EXPECT_EQ(refusal_of([](auto& a) { a.beta = 0.5; }), "beta: 0.5 is not in (0, 0.5)");
  EXPECT_EQ(refusal_of([](auto& a) { a = {0.5, 0.4, 0.49, 0.01}; }), "accepted");
}

TEST(SprtParameters, AreCheckedByTheTest) {
  EXPECT_EQ(refusal([] { return Sprt({.p0 = 0.9, .p1 = 0.95}); }), "p1: 0.95 is not in (0, p0)");
}

}  // namespace
}  // namespace landfall
