// Competitor (b): SUNDIALS CVODE, Adams with fixed-point iteration and BDF with Newton iteration and exact Jacobian,
// its own root finding, modes and sliding fields by hand, a restart after every root.
#include <array>
#include <cstddef>
#include <cvode/cvode.h>
#include <memory>
#include <nvector/nvector_serial.h>
#include <string>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <vector>

#include "gene_ring.hpp"
#include "networks.hpp"
#include "protocol.hpp"
#include "sliding_problems.hpp"

namespace compare {
namespace {

template <class Problem>
int right_hand_side(realtype, N_Vector x, N_Vector slope, void* problem) {
  (*static_cast<Problem*>(problem))(N_VGetArrayPointer(x), N_VGetArrayPointer(slope));
  return 0;
}

template <class Problem>
int roots(realtype, N_Vector x, realtype* values, void* problem) {
  for (std::size_t k = 0; k < Problem::functions; ++k) {
    values[k] = static_cast<Problem*>(problem)->value(k, N_VGetArrayPointer(x));
  }
  return 0;
}

template <class Problem>
int jacobian(realtype, N_Vector x, N_Vector, SUNMatrix matrix, void* problem, N_Vector, N_Vector, N_Vector) {
  static_cast<Problem*>(problem)->jacobian(N_VGetArrayPointer(x), SUNDenseMatrix_Data(matrix));
  return 0;
}

struct Destroy {
  void operator()(N_Vector x) const { N_VDestroy(x); }
  void operator()(SUNMatrix matrix) const { SUNMatDestroy(matrix); }
  void operator()(SUNLinearSolver solver) const { SUNLinSolFree(solver); }
  void operator()(SUNNonlinearSolver solver) const { SUNNonlinSolFree(solver); }
};
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Destroy>;

/// CVODE for one problem; created once, restarted for every integration: creation is not part of the time.
template <class Problem>
class Cvode {
 public:
  explicit Cvode(const std::string& method) {
    SUNContext_Create(nullptr, &context_);
    x_.reset(N_VNew_Serial(Problem::n, context_));
    set_start();
    const bool adams = method == "adams";
    memory_ = CVodeCreate(adams ? CV_ADAMS : CV_BDF, context_);
    CVodeInit(memory_, right_hand_side<Problem>, 0.0, x_.get());
    CVodeSStolerances(memory_, 1e-8, 1e-10);
    CVodeSetUserData(memory_, &problem_);
    CVodeSetMaxNumSteps(memory_, 10000000);
    CVodeRootInit(memory_, Problem::functions, roots<Problem>);
    directions_.fill(-1);
    CVodeSetRootDirection(memory_, directions_.data());
    CVodeSetNoInactiveRootWarn(memory_);
    if (adams) {
      iteration_.reset(SUNNonlinSol_FixedPoint(x_.get(), 0, context_));
      CVodeSetNonlinearSolver(memory_, iteration_.get());
    } else {
      matrix_.reset(SUNDenseMatrix(Problem::n, Problem::n, context_));
      solver_.reset(SUNLinSol_Dense(x_.get(), matrix_.get(), context_));
      CVodeSetLinearSolver(memory_, solver_.get(), matrix_.get());
      CVodeSetJacFn(memory_, jacobian<Problem>);
    }
  }
  Cvode(const Cvode&) = delete;
  Cvode& operator=(const Cvode&) = delete;
  ~Cvode() {
    CVodeFree(&memory_);
    iteration_.reset();
    solver_.reset();
    matrix_.reset();
    x_.reset();
    SUNContext_Free(&context_);
  }

  Run to_end(Tolerances tolerances) {
    Run run;
    run.events.reserve(1024);
    problem_ = Problem();
    set_start();
    CVodeSStolerances(memory_, tolerances.rtol, tolerances.atol);
    CVodeReInit(memory_, 0.0, x_.get());
    CVodeSetStopTime(memory_, Problem::until);
    double t = 0.0;
    while (t < Problem::until) {
      const int outcome = CVode(memory_, Problem::until, x_.get(), &t, CV_NORMAL);
      if (outcome != CV_ROOT_RETURN) {
        if (outcome < 0) run.status = "failed: " + std::to_string(outcome);
        break;
      }
      cross();
      run.events.push_back(t);
      count(run);
      CVodeReInit(memory_, t, x_.get());
      CVodeSetStopTime(memory_, Problem::until);
    }
    count(run);
    const double* x = N_VGetArrayPointer(x_.get());
    run.x.assign(x, x + Problem::n);
    return run;
  }

 private:
  void set_start() {
    const auto start = Problem::start();
    for (std::size_t i = 0; i < Problem::n; ++i) N_VGetArrayPointer(x_.get())[i] = start[i];
  }
  void cross() {
    std::array<int, Problem::functions> found{};
    CVodeGetRootInfo(memory_, found.data());
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (found[k] == 0) continue;
      problem_.cross(k, N_VGetArrayPointer(x_.get()));
      return;
    }
  }
  void count(Run& run) const {
    long steps = 0;
    long evaluations = 0;
    CVodeGetNumSteps(memory_, &steps);
    CVodeGetNumRhsEvals(memory_, &evaluations);
    run.steps += steps;
    run.evaluations += evaluations;
  }

  SUNContext context_ = nullptr;
  void* memory_ = nullptr;
  Problem problem_;
  Owned<N_Vector> x_;
  Owned<SUNMatrix> matrix_;
  Owned<SUNLinearSolver> solver_;
  Owned<SUNNonlinearSolver> iteration_;
  std::array<int, Problem::functions> directions_{};
};

template <class Problem>
void sweep(const Request& request) {
  if (request.method != "adams" && request.method != "bdf") unknown(request);
  Cvode<Problem> cvode(request.method);
  for (const double tolerance : request.tolerances) {
    Run run;
    const Timing timing = median_time(request.seconds, [&] { run = cvode.to_end({tolerance, 0.01 * tolerance}); });
    print(request, tolerance, timing, run);
  }
}

template <class Network>
void sweep_network(const Request& request) {
  if (request.variant == "relevant") return sweep<NetworkProblem<Network, Watch::relevant>>(request);
  if (request.variant == "all") return sweep<NetworkProblem<Network, Watch::all>>(request);
  unknown(request);
}

void sweep_problem(const Request& request) {
  if (request.problem == "irma") return sweep_network<Irma>(request);
  if (request.problem == "gene-ring") return sweep_network<GeneRing<24>>(request);
  if (request.problem == "gene-ring-active") return sweep_network<GeneRing<0>>(request);
  if (request.problem == "stick-slip") return sweep<StickSlip>(request);
  if (request.problem == "relay-feedback") return sweep<Relay>(request);
  unknown(request);
}

}  // namespace
}  // namespace compare

int main(int count, char** arguments) { compare::sweep_problem(compare::request_from(count, arguments)); }
