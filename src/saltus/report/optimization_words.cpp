#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "saltus/report/findings.hpp"
#include "saltus/report/optimization_table_internal.hpp"
#include "saltus/report/optimization_words_internal.hpp"

namespace saltus::report {
namespace {

using Tone = Finding::Tone;

Tone good_if(bool good) { return good ? Tone::good : Tone::bad; }

/// Two digits are enough for an error.
std::string error_text(double value) {
  if (!std::isfinite(value)) return "an unknown error";
  return value == 0.0 ? "0" : fmt::format("{:.2g}", value);
}

std::string counted(int count, std::string_view one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : (one.ends_with("ch") ? "es" : "s"));
}

Finding residuals(const result::Certificate& certificate, double tolerance) {
  const auto within = [tolerance](double residual) { return std::abs(residual) <= tolerance; };  // false for NaN
  const auto piece = [&](double residual, std::string_view what, std::string_view good, std::string_view bad) {
    if (!std::isfinite(residual)) return fmt::format("{} NOT known", what);
    return fmt::format("{} {}", within(residual) ? good : bad, error_text(residual));
  };
  const double primal = certificate.primal_infeasibility, stationarity = certificate.stationarity;
  const double complementarity = certificate.complementarity_residual;
  const bool all = within(primal) && within(complementarity) && within(stationarity);
  auto text = fmt::format(
      "{}; {}; {}", piece(primal, "feasibility", "feasible to", "NOT feasible: a bound or row is violated by"),
      piece(complementarity, "complementarity", "complementarity", "complementarity NOT reached:"),
      piece(stationarity, "stationarity", "stationary to", "NOT stationary: the gradient of the Lagrangian is"));
  text.front() = text.front() == 'f' ? 'F' : text.front();
  return {good_if(all), text + (all ? "." : fmt::format(" (allowed {:.2g}).", tolerance))};
}

std::string pairs_text(int biactive) {
  if (biactive == 0) return "no pair has both sides at zero, so this is a smooth optimum within its pieces";
  return fmt::format("{} {} both sides at zero", counted(biactive, "pair"), biactive == 1 ? "has" : "have");
}

Finding b_stationarity(const result::Certificate& certificate) {
  const auto type = certificate.stationarity_type ? std::string(name(*certificate.stationarity_type)) : std::string();
  const auto pairs = pairs_text(certificate.biactive);
  if (!certificate.b_stationary) {
    return {Tone::bad, fmt::format("Not decided whether it is B-stationary{}{}.",
                                   type.empty() ? "" : fmt::format(" (multipliers: {})", type),
                                   certificate.biactive > 0 ? ": " + pairs : "")};
  }
  if (*certificate.b_stationary) {
    return {Tone::good, fmt::format("B-stationary{}: no feasible direction improves the objective to first order; {}.",
                                    type.empty() ? "" : fmt::format(" ({})", type), pairs)};
  }
  return {Tone::bad,
          fmt::format("NOT B-stationary{}: a feasible direction improves the objective to first order{}; {}.",
                      type.empty() ? "" : fmt::format(" ({})", type),
                      certificate.lpcc_decrease
                          ? fmt::format(" ({} of its steepest)", error_text(-*certificate.lpcc_decrease))
                          : "",
                      pairs)};
}

std::string names_text(const std::vector<std::string>& names, std::size_t all) {
  std::string text;
  for (const auto& name : names) text += fmt::format("{}`{}`", text.empty() ? "" : ", ", name);
  return names.size() < all ? text + ", ..." : text;
}

/// What gradients and second derivatives say; nothing where they are not known.
std::vector<Finding> regularity(const result::Certificate& certificate) {
  if (!certificate.licq) return {};
  std::string text = "Gradients of active constraints are linearly independent";
  if (!*certificate.licq) {
    text = fmt::format("Gradients of active constraints depend on each other: {} of them {} of others ({})",
                       certificate.dependent_rows,
                       certificate.dependent_rows == 1 ? "is a combination" : "are combinations",
                       names_text(certificate.dependent, certificate.dependent.size()));
  }
  const bool is_saddle = certificate.sosc == false;
  if (certificate.sosc == true) text += "; second-order sufficient: no point of the same pieces nearby is better";
  if (is_saddle) text += "; NOT second-order sufficient: along some direction the objective falls to second order";
  if (!certificate.sosc) text += "; second derivatives decide nothing";
  return {{is_saddle ? Tone::bad : Tone::neutral, text + "."}};
}

std::string limits_text(const std::vector<double>& range) {
  const double lower = range.front(), upper = range.back();
  if (!std::isfinite(lower) && !std::isfinite(upper)) return "nothing determines it";
  if (!std::isfinite(upper)) return fmt::format("at least {:.6g}", lower);
  if (!std::isfinite(lower)) return fmt::format("at most {:.6g}", upper);
  return fmt::format("from {:.6g} to {:.6g}", lower, upper);
}

/// The first multiplier that is not unique, and how many others.
std::vector<Finding> multiplier_findings(const std::vector<result::ConstraintMultiplier>& multipliers) {
  const auto is_open = [](const auto& one) { return one.range.size() == 2; };
  const auto first = std::find_if(multipliers.begin(), multipliers.end(), is_open);
  if (first == multipliers.end()) return {};
  const auto others = std::count_if(first + 1, multipliers.end(), is_open);
  return {{Tone::neutral,
           fmt::format("The multiplier of `{}` at t = {:.6g} is not unique: {}{}.", first->name, first->time,
                       limits_text(first->range),
                       others == 0 ? "" : fmt::format("; {} more {} not", others, others == 1 ? "is" : "are"))}};
}

std::string interval_text(const result::Optimization& optimization, int interval) {
  const auto k = static_cast<std::size_t>(interval);
  if (interval < 0 || k + 1 >= optimization.grid.size()) return "";
  return fmt::format(" in interval {} (t = {:.4g} to {:.4g})", interval, optimization.grid[k],
                     optimization.grid[k + 1]);
}

Finding interval_finding(const result::Optimization& optimization, const result::Verification& verification) {
  const double defect = verification.interval_defect;
  if (std::isnan(defect))
    return {Tone::bad, "Not every interval could be simulated, so nothing is known of the states."};
  const bool fine = defect <= verification.tolerance;
  const auto where = verification.state.empty() ? "the states" : fmt::format("`{}`", verification.state);
  return {good_if(fine),
          fmt::format("Simulated event by event, each interval from its own node: off by at most {} of the range of {}"
                      "{}; {} {:.2g}.",
                      error_text(defect), where, interval_text(optimization, verification.interval),
                      fine ? "allowed is" : "that is MORE than the allowed", verification.tolerance)};
}

Finding switch_finding(const result::Verification& verification) {
  const auto& [missed, extra] = std::pair(verification.switches_missed, verification.switches_extra);
  const double error = verification.switch_time_error;
  const auto times = error > 0.0 ? "; times of switches differ by at most " + error_text(error) : "";
  if (missed == 0 && extra == 0) return {Tone::good, fmt::format("No switch is missed or added{}.", times)};
  std::string text;
  if (missed > 0) text += counted(missed, "switch") + " of the simulation not in the solution";
  if (extra > 0)
    text +=
        fmt::format("{}{} of the solution not in the simulation", text.empty() ? "" : ", ", counted(extra, "switch"));
  return {Tone::bad, fmt::format("{}{}.", text, times)};
}

Finding path_finding(const result::Verification& verification) {
  if (verification.path_violation <= 0.0) {
    return {Tone::good, "Bounds and path constraints hold along the whole simulation, not only at the nodes."};
  }
  if (std::isnan(verification.path_violation)) {
    return {Tone::neutral, "Whether bounds and path constraints hold between the nodes is not known."};
  }
  if (verification.path_violations.empty()) {
    return {Tone::neutral, fmt::format("Along the simulation bounds and path constraints are violated by at most {}.",
                                       error_text(verification.path_violation))};
  }
  const auto& [name, time, value, share] = verification.path_violations.front();
  const auto others = verification.path_violations.size() - 1;
  return {share > verification.tolerance ? Tone::bad : Tone::neutral,
          fmt::format(
              "Along the simulation `{}` is violated by at most {} ({} of its range) at t = {:.6g}{}.", name,
              error_text(value), error_text(share), time,
              others == 0 ? "" : fmt::format("; {} more {} by a smaller share", others, others == 1 ? "is" : "are"))};
}

/// What a person would see in a picture of bodies of length 1.
constexpr double visible_depth = 1e-3;

Finding penetration_finding(const result::Penetration& penetration) {
  const bool fine = penetration.solution <= visible_depth;
  return {good_if(fine), fmt::format("Bodies are at most {} deep in each other in the solution, {} in its simulation.",
                                     error_text(penetration.solution), error_text(penetration.simulation))};
}

/// Information, never a verdict: an unstable system fails it at every accuracy.
Finding open_loop_finding(std::string text, const result::OpenLoop& open_loop) {
  if (!is_done(open_loop.termination)) {
    text += fmt::format("the simulation ended early ({}).", name(open_loop.termination));
    return {Tone::neutral, open_loop.message.empty() ? text : text + " " + open_loop.message};
  }
  text += fmt::format("the end state is off by {} of its range", error_text(open_loop.end_state_error));
  if (open_loop.terminal_violation > 0.0) {
    text += fmt::format(", terminal constraints are violated by at most {}", error_text(open_loop.terminal_violation));
  }
  if (std::isfinite(open_loop.amplification)) {
    text += fmt::format("; the system itself magnifies a small error at the start by up to {:.2g}",
                        open_loop.amplification);
  }
  return {Tone::neutral, text + "."};
}

std::string feedback_words(const std::vector<std::pair<std::string, double>>& plant) {
  std::string text = "With feedback from the states";
  for (const auto& [name, value] : plant) text += fmt::format(", {} = {}", name, value);
  return text + ": ";
}

}  // namespace

std::vector<Finding> certificate_findings(const result::Certificate& certificate, double tolerance) {
  std::vector<Finding> findings{residuals(certificate, tolerance), b_stationarity(certificate)};
  if (certificate.b_stationary == true && certificate.other_sides_tried == false) {
    findings.push_back(
        {Tone::neutral,
         "Not every mode sequence of this point was tried (a limit, or an interval with too few elements): "
         "switches a little earlier or later may be better."});
  }
  for (auto& finding : regularity(certificate)) findings.push_back(std::move(finding));
  return findings;
}

std::vector<Finding> certificate_findings(const result::Result& result) {
  const auto& certificate = result.optimization->certificate;
  auto findings = certificate_findings(certificate, residual_tolerance(result.options));
  if (certificate.licq == false && !result.contacts.empty()) {
    findings.push_back({Finding::Tone::neutral,
                        "That is usual while a contact stays closed: its gap and the rate of the gap are both zero, so "
                        "that equations repeat each other. Nothing has to be changed."});
  }
  for (auto& finding : multiplier_findings(result.optimization->multipliers)) findings.push_back(std::move(finding));
  return findings;
}

std::vector<Finding> verification_findings(const result::Optimization& optimization) {
  if (!optimization.verification) return {{Tone::neutral, "Not simulated again."}};
  const auto& verification = *optimization.verification;
  std::vector<Finding> findings;
  if (!verification.message.empty()) findings.push_back({Tone::bad, verification.message});
  findings.push_back(interval_finding(optimization, verification));
  findings.push_back(switch_finding(verification));
  findings.push_back(path_finding(verification));
  if (verification.penetration) findings.push_back(penetration_finding(*verification.penetration));
  findings.push_back(open_loop_finding("Controls over the whole horizon, from the start on: ", verification.open_loop));
  if (verification.closed_loop) {
    findings.push_back(open_loop_finding(feedback_words(verification.plant), *verification.closed_loop));
  }
  return findings;
}

std::vector<std::pair<std::string, double>> objective_terms(const result::ObjectiveTerms& terms) {
  std::vector<std::pair<std::string, double>> list{{"running", terms.running},
                                                   {"terminal", terms.terminal},
                                                   {"least squares", terms.least_squares},
                                                   {"time", terms.time},
                                                   {"penalties", terms.penalties}};
  std::erase_if(list, [](const auto& term) { return term.second == 0.0; });
  return list;
}

std::vector<SaidOfOptimum> said_of_optimum(const result::Result& result) {
  std::vector<SaidOfOptimum> said;
  if (!result.optimization) return said;
  const auto word = [](Tone tone) { return tone == Tone::good ? "good" : tone == Tone::bad ? "bad" : "neutral"; };
  for (const auto& finding : certificate_findings(result))
    said.push_back({"certificate", word(finding.tone), finding.text});
  for (const auto& finding : verification_findings(*result.optimization))
    said.push_back({"simulation", word(finding.tone), finding.text});
  return said;
}

}  // namespace saltus::report
