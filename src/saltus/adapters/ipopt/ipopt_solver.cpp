#include "saltus/adapters/ipopt/ipopt_solver.hpp"

#include <IpIpoptApplication.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLPAdapter.hpp>
#include <algorithm>
#include <cstdlib>
#include <dlfcn.h>

#include "saltus/adapters/ipopt/algorithm_builder_internal.hpp"
#include "saltus/adapters/ipopt/ipopt_program_internal.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/symbolic_lock.hpp"

namespace saltus::adapters {
namespace {

using result::Termination;

struct Outcome {
  Termination termination;
  const char* message;
};

Outcome outcome_of(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Solve_Succeeded:
    case Ipopt::Feasible_Point_Found:
    case Ipopt::Solved_To_Acceptable_Level:
      return {Termination::completed, ""};
    case Ipopt::Infeasible_Problem_Detected:
      return {Termination::infeasible, "Ipopt converged to a point that is locally infeasible"};
    case Ipopt::Search_Direction_Becomes_Too_Small:
      return {Termination::step_size_too_small, "Ipopt's search direction became too small"};
    case Ipopt::Diverging_Iterates:
      return {Termination::not_converged, "Ipopt's iterates diverge"};
    case Ipopt::User_Requested_Stop:
      return {Termination::stopped_by_user, "stopped on request"};
    case Ipopt::Maximum_Iterations_Exceeded:
      return {Termination::iteration_limit, "Ipopt reached the limit of iterations"};
    case Ipopt::Restoration_Failed:
      return {Termination::not_converged, "Ipopt's restoration phase failed"};
    case Ipopt::Error_In_Step_Computation:
      return {Termination::factorization_failed, "Ipopt could not compute a search direction"};
    case Ipopt::Maximum_CpuTime_Exceeded:
    case Ipopt::Maximum_WallTime_Exceeded:
      return {Termination::time_limit, "Ipopt reached the time limit"};
    case Ipopt::Not_Enough_Degrees_Of_Freedom:
      return {Termination::infeasible, "the problem has more equations than free variables"};
    case Ipopt::Invalid_Number_Detected:
      return {Termination::evaluation_failed, "a function of the problem is not finite"};
    case Ipopt::Insufficient_Memory:
      return {Termination::factorization_failed, "Ipopt ran out of memory"};
    default:
      return {Termination::not_converged, "Ipopt ended with an internal error"};
  }
}

/// OpenBLAS spins with as many threads as there are cores, which only costs here: fronts are small.
void use_one_thread() {
  using SetThreads = void (*)(int);
  if (std::getenv("OPENBLAS_NUM_THREADS") != nullptr) return;
  if (auto* found = dlsym(RTLD_DEFAULT, "openblas_set_num_threads"); found != nullptr) {
    reinterpret_cast<SetThreads>(found)(1);
  }
}

/// Whether the application still has what it needs to be used again: a problem that was not solved takes nothing from
/// it.
bool keeps_structures(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Invalid_Problem_Definition:
    case Ipopt::Invalid_Option:
    case Ipopt::Not_Enough_Degrees_Of_Freedom:
    case Ipopt::Unrecoverable_Exception:
    case Ipopt::NonIpopt_Exception_Thrown:
    case Ipopt::Insufficient_Memory:
    case Ipopt::Internal_Error:
      return false;
    default:
      return true;
  }
}

/// An application with what all problems have in common.
Ipopt::SmartPtr<Ipopt::IpoptApplication> new_application() {
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(/*create_console_out=*/false);
  use_one_thread();
  auto options = application->Options();
  const bool are_set = options->SetIntegerValue("print_level", 0) && options->SetStringValue("sb", "yes") &&
                       options->SetStringValue("linear_solver", "mumps") &&
                       // Permutations by values make factors dense where the equations depend on each other.
                       options->SetIntegerValue("mumps_permuting_scaling", 0) &&
                       // Relaxed bounds would let lambda and alpha become negative, and with them products of pairs.
                       options->SetNumericValue("bound_relax_factor", 0.0) &&
                       options->SetStringValue("mu_oracle", "quality-function") &&
                       options->SetStringValue("fixed_variable_treatment", "make_parameter");
  SALTUS_ASSERT(are_set);
  // An empty name: no option file of the current folder changes results.
  const auto status = application->Initialize(std::string());
  SALTUS_ASSERT(status == Ipopt::Solve_Succeeded);
  return application;
}

bool has_multipliers(const mpcc::Problem& nlp, const solver::NlpPoint& point) {
  return point.y.size() == nlp.constraints() && point.z_lower.size() == nlp.variables() &&
         point.z_upper.size() == nlp.variables();
}

/// How far Ipopt moves a start without multipliers inside of its bounds, unless a barrier parameter is given.
constexpr double cold_push = 0.01;

/// How far a start with multipliers, or without them, is moved inside of its bounds.
bool set_start(Ipopt::OptionsList& options, bool with_multipliers, double push) {
  bool are_set = options.SetStringValue("warm_start_init_point", with_multipliers ? "yes" : "no");
  for (const char* name : {"warm_start_bound_push", "warm_start_bound_frac", "warm_start_slack_bound_push",
                           "warm_start_slack_bound_frac", "warm_start_mult_bound_push"}) {
    are_set = are_set && options.SetNumericValue(name, push);
  }
  return are_set;
}

bool set_time_limit(Ipopt::OptionsList& options, const solver::NlpOptions& wanted) {
  constexpr double unlimited = 1e20;  // Ipopt's own default
  constexpr double least = 1e-9;      // Ipopt wants more than 0
  return options.SetNumericValue("max_wall_time", std::max(wanted.time_limit.value_or(unlimited), least));
}

/// That its loop ends only where it is told to: no error is small enough.
void set_options_of_loop(Ipopt::IpoptApplication& application, const solver::NlpOptions& wanted,
                         bool with_multipliers) {
  constexpr double push = 1e-6;
  constexpr double unreachable = 1e-20;
  auto options = application.Options();
  const bool are_set = options->SetNumericValue("tol", unreachable) && options->SetIntegerValue("acceptable_iter", 0) &&
                       options->SetIntegerValue("max_iter", wanted.iteration_limit) &&
                       set_time_limit(*options, wanted) && options->SetStringValue("mu_strategy", "monotone") &&
                       set_start(*options, with_multipliers, push);
  SALTUS_ASSERT(are_set);
}

solver::NlpReport report_of(const Outcome& outcome, Ipopt::ApplicationReturnStatus status, const IpoptProgram& program,
                            Ipopt::IpoptApplication& application) {
  solver::NlpReport report;
  report.termination = outcome.termination;
  report.diverging = status == Ipopt::Diverging_Iterates;
  report.objective = program.objective();
  report.evaluation_seconds = program.evaluation_seconds();
  report.message = outcome.message;
  if (const auto statistics = application.Statistics(); Ipopt::IsValid(statistics)) {
    report.iterations = statistics->IterationCount();
  }
  return report;
}

}  // namespace

struct IpoptSolver::Implementation {
  LinearSolver linear_solver;
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new_application();
  Ipopt::SmartPtr<IpoptProgram> program = new IpoptProgram;
  Ipopt::SmartPtr<Ipopt::NLP> seen;  ///< the program as the algorithm sees it
  Ipopt::SmartPtr<Ipopt::AlgorithmBuilder> builder;
  bool has_structures = false;  ///< it has solved a problem; the sizes of the next are its own

  explicit Implementation(LinearSolver chosen)
      : linear_solver(chosen), builder(new AlgorithmBuilder(chosen, *program)) {
    seen = new Ipopt::TNLPAdapter(Ipopt::GetRawPtr(program), Ipopt::ConstPtr(application->Jnlst()));
  }

  void set_options(const solver::NlpOptions& wanted, bool with_multipliers) {
    auto options = application->Options();
    const double feasible = std::max(wanted.tolerance, 1e-10);
    bool are_set = options->SetNumericValue("tol", wanted.tolerance) &&
                   options->SetNumericValue("dual_inf_tol", wanted.tolerance) &&
                   options->SetNumericValue("compl_inf_tol", wanted.tolerance) &&
                   options->SetNumericValue("acceptable_tol", wanted.acceptable_tolerance) &&
                   // Only optimality may be poor at an acceptable point (Ipopt's own choice is 1e-2 for both): a point
                   // that is not feasible solves nothing.
                   options->SetNumericValue("constr_viol_tol", feasible) &&
                   options->SetNumericValue("acceptable_constr_viol_tol", feasible) &&
                   options->SetIntegerValue("max_iter", wanted.iteration_limit) && set_time_limit(*options, wanted) &&
                   set_start(*options, with_multipliers, wanted.warm_push);
    // Only the monotone strategy begins with a given parameter; the adaptive one chooses its own.
    const auto& first_mu = wanted.first_barrier_mu;
    are_set = are_set && options->SetStringValue("mu_strategy", first_mu ? "monotone" : "adaptive") &&
              options->SetNumericValue("mu_init", first_mu.value_or(0.1));
    for (const char* name : {"bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac"}) {
      are_set = are_set && options->SetNumericValue(name, std::min(cold_push, first_mu.value_or(cold_push)));
    }
    SALTUS_ASSERT(are_set);
  }
};

IpoptSolver::IpoptSolver(LinearSolver linear_solver)
    : implementation_(std::make_unique<Implementation>(linear_solver)) {}
IpoptSolver::~IpoptSolver() = default;

solver::NlpReport IpoptSolver::solve(mpcc::Problem& nlp, solver::NlpPoint& point, const solver::NlpOptions& options) {
  SALTUS_ASSERT(point.w.size() == nlp.variables());
  auto& [linear_solver, application, program, seen, builder, has_structures] = *implementation_;
  implementation_->set_options(options, has_multipliers(nlp, point));
  program->set(nlp, point, options);
  const auto status = [&] {
    const SymbolicPause pause;  // Ipopt itself lets one thread at a time use MUMPS
    return has_structures ? application->ReOptimizeNLP(seen) : application->OptimizeNLP(seen, builder);
  }();
  has_structures = keeps_structures(status);

  const bool is_stopped = status == Ipopt::User_Requested_Stop;
  const bool is_exhausted = is_stopped && program->is_exhausted();
  Outcome outcome = outcome_of(status);
  if (is_exhausted)
    outcome = outcome_of(Ipopt::Solved_To_Acceptable_Level);
  else if (is_stopped && program->stands_still())
    outcome = outcome_of(Ipopt::Search_Direction_Becomes_Too_Small);
  else if (is_stopped && program->is_cut_off())
    outcome = {Termination::not_converged, "its objective is too large"};
  return report_of(outcome, status, *program, *application);
}

solver::NlpReport IpoptSolver::follow(mpcc::Problem& nlp, solver::NlpPoint& point, const solver::NlpOptions& options,
                                      double first, int longest, const solver::AskNextBarrier& next) {
  SALTUS_ASSERT(point.w.size() == nlp.variables());
  // Of its own: meanwhile other problems are solved.
  const auto application = new_application();
  set_options_of_loop(*application, options, has_multipliers(nlp, point));
  const Ipopt::SmartPtr<IpoptProgram> program = new IpoptProgram;
  program->set(nlp, point, options);
  program->let_it_run(longest);
  BarrierLoop loop{.first_mu = first, .next = next, .program = *program};
  const Ipopt::SmartPtr<Ipopt::NLP> seen =
      new Ipopt::TNLPAdapter(Ipopt::GetRawPtr(program), Ipopt::ConstPtr(application->Jnlst()));
  Ipopt::SmartPtr<Ipopt::AlgorithmBuilder> builder =
      new AlgorithmBuilder(implementation_->linear_solver, *program, &loop);
  const auto status = [&] {
    const SymbolicPause pause;
    return application->OptimizeNLP(seen, builder);
  }();
  Outcome outcome = outcome_of(status);
  if (loop.is_ended)
    outcome = {Termination::completed, ""};
  else if (program->is_too_long())
    outcome = {Termination::step_size_too_small, "a barrier problem takes too long"};
  return report_of(outcome, status, *program, *application);
}

}  // namespace saltus::adapters
