#include "saltus/base/other_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "saltus/base/contains.hpp"
#include "saltus/base/error.hpp"
#include "saltus/base/text.hpp"

namespace saltus {
namespace {

/// Words with blanks between. A word may stand in several rows: a place knows some of the names only.
struct OtherWords {
  std::string_view theirs;
  std::string_view ours;
};

constexpr std::array other_words{
    // keys of the model file
    OtherWords{"init value start initial_value x0 ic", "initial"},
    OtherWords{"min minimum lb lower_bound", "lower"},
    OtherWords{"max maximum ub upper_bound", "upper"},
    OtherWords{"bounds limits range", "lower upper"},
    OtherWords{"upper high", "on"},
    OtherWords{"lower low", "off"},
    OtherWords{"condition guard trigger if", "when"},
    OtherWords{"reset update assign then do action", "set"},
    // tables of the model file
    OtherWords{"params constants", "parameters"},
    OtherWords{"variables vars init initial_conditions initial_values", "states"},
    OtherWords{"ode odes equations derivatives rates rhs", "dynamics"},
    OtherWords{"algebraic auxiliary aux expressions", "definitions"},
    OtherWords{"simulation settings options solver", "simulate"},
    OtherWords{"optimization optimisation ocp optimal_control", "optimize"},
    OtherWords{"resets transitions impacts", "jumps"},
    // values
    OtherWords{"falling fall decreasing negative", "down"},
    OtherWords{"rising rise increasing positive", "up"},
    OtherWords{"any either", "both"},
    OtherWords{"rk45 ode45 tsit5", "dopri5"},
    OtherWords{"ode89 vern9", "dop853"},
    OtherWords{"bdf ode15s rodas5", "radau5"},
    OtherWords{"lsoda", "auto"},
    // options
    OtherWords{"until t tf tend t_end tstop t_final final_time end duration", "until horizon"},
    OtherWords{"dt h step timestep time_step step_size stepsize", "every max_step"},
    OtherWords{"tolerance accuracy precision", "rtol atol"},
    OtherWords{"engine backend solver", "method"},
    OtherWords{"stepper solver", "integrator"},
    OtherWords{"sweep scan range", "over"},
    OtherWords{"samples", "runs"},
    OtherWords{"threads workers", "jobs"},
    OtherWords{"param parameter", "set"},
    OtherWords{"plot", "report"},
    // optimal control
    OtherWords{"intervals n", "control_intervals"},
    OtherWords{"cost objective", "running_cost terminal_cost"},
    OtherWords{"stage_cost lagrange", "running_cost"},
    OtherWords{"final_cost end_cost mayer", "terminal_cost"},
    OtherWords{"constraints", "path_constraints terminal_constraints"},
};

/// Without dashes and tables before it, in small letters: --T-end is t_end, event.max_step is max_step.
std::string plain(std::string_view name) {
  name.remove_prefix(std::min(name.find_first_not_of('-'), name.size()));
  std::string word(name.substr(name.rfind('.') + 1));
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return c == '-' ? '_' : static_cast<char>(std::tolower(c)); });
  return word;
}

}  // namespace

std::vector<std::string> names_meant(std::string_view word, const std::vector<std::string>& known) {
  const auto theirs = plain(word);
  std::vector<std::string_view> meant;
  for (const auto& row : other_words) {
    if (!contains(split(row.theirs, ' '), theirs)) continue;
    for (const auto name : split(row.ours, ' ')) meant.push_back(name);
  }
  std::vector<std::string> names;
  std::copy_if(known.begin(), known.end(), std::back_inserter(names),
               [&](const std::string& name) { return contains(meant, plain(name)) && plain(name) != theirs; });
  return names;
}

std::vector<std::string> nearest_words(const std::string& word, const std::vector<std::string>& known) {
  const auto is_same = [written = plain(word)](const std::string& name) { return plain(name) == written; };
  const bool is_known = std::any_of(known.begin(), known.end(), is_same);
  auto meant = is_known ? std::vector<std::string>() : names_meant(word, known);
  return meant.empty() ? nearest_names(word, known) : meant;
}

std::string suggest_word(const std::string& word, const std::vector<std::string>& known) {
  return suggestion(nearest_words(word, known), known);
}

}  // namespace saltus
