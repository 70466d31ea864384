// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

// The input of mutate_test.py. That a < b here makes no mutant.
namespace toy {

constexpr int kStep = 3;
static_assert(1 < 2);

int clipped(int a, int limit) {
  if (a < 0) return 0;
  return std::min(a, limit);
}

bool only_first(bool a, bool b) { return a && !b; }

int steps(int count) {
  int total = 0;
  for (int i = 0; i < count; ++i) total += kStep;
  return total;
}

template <class T>
T half(T x) {
  return x * 0.5;
}

}  // namespace toy

/// The tests: 0 where all hold. None looks at the borders of clipped() or at only_first(false, true).
int main() {
  using namespace toy;
  if (clipped(-5, 10) != 0 || clipped(5, 10) != 5 || clipped(50, 10) != 10) return 1;
  if (!only_first(true, false) || only_first(true, true) || only_first(false, false)) return 1;
  if (steps(4) != 12) return 1;
  return half(3.0) == 1.5 ? 0 : 1;
}
