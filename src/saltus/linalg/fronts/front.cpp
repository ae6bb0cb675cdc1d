// The loops for the processor that runs them: the plain ones, and ones for processors with AVX2. Both do the same
// operations in the same order, so results are the same bits on either.
#include "saltus/linalg/fronts/front_internal.hpp"
#include "saltus/linalg/fronts/front_loops_internal.hpp"

namespace saltus::linalg::fronts {
namespace {

Eliminated eliminate_plain(const Front& front, const FrontWork& work, PivotRule rule) {
  return loops::Elimination(front, work, rule).run();
}
void forward_plain(const Front& front, int pivots, double* x) { loops::forward(front, pivots, x); }
void backward_plain(const Front& front, int pivots, double* x) { loops::backward(front, pivots, x); }

#if defined(__x86_64__) && defined(__GNUC__)
#define SALTUS_WIDE __attribute__((target("avx2")))
SALTUS_WIDE Eliminated eliminate_wide(const Front& front, const FrontWork& work, PivotRule rule) {
  return loops::Elimination(front, work, rule).run();
}
SALTUS_WIDE void forward_wide(const Front& front, int pivots, double* x) { loops::forward(front, pivots, x); }
SALTUS_WIDE void backward_wide(const Front& front, int pivots, double* x) { loops::backward(front, pivots, x); }

bool is_wide() { return __builtin_cpu_supports("avx2") != 0; }
#else
constexpr auto eliminate_wide = eliminate_plain;
constexpr auto forward_wide = forward_plain;
constexpr auto backward_wide = backward_plain;

bool is_wide() { return false; }
#endif

}  // namespace

Eliminated eliminate(const Front& front, const FrontWork& work, PivotRule rule) {
  return is_wide() ? eliminate_wide(front, work, rule) : eliminate_plain(front, work, rule);
}

void solve_forward(const Front& front, int pivots, double* x) {
  is_wide() ? forward_wide(front, pivots, x) : forward_plain(front, pivots, x);
}

void solve_backward(const Front& front, int pivots, double* x) {
  is_wide() ? backward_wide(front, pivots, x) : backward_plain(front, pivots, x);
}

}  // namespace saltus::linalg::fronts
