#include "saltus/frontend/sweep_plan.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/other_words.hpp"
#include "saltus/base/text.hpp"
#include "saltus/pipeline/random_numbers.hpp"

namespace saltus::frontend {
namespace {

tl::unexpected<Error> refused_plan(std::string message, std::string remedy) {
  return tl::unexpected(Error{ErrorCode::parse_failure, std::move(message), std::move(remedy), {}, {}});
}

std::optional<double> number_in(std::string_view text) {
  const auto number = whole_text_as<double>(without_plus(trimmed(text)));
  return number && std::isfinite(*number) ? number : std::nullopt;
}

constexpr std::string_view sample_remedy = "for example --sample v=normal(3,0.1), uniform(0,1) or lognormal(0,0.5)";

/// A:B:N as numbers, the ends exact.
Expected<std::vector<std::string>> range_values(const std::string& typed, std::string_view text) {
  const auto parts = split(text, ':');
  const auto first = number_in(parts.front());
  const auto last = parts.size() == 3 ? number_in(parts[1]) : std::nullopt;
  const auto count = parts.size() == 3 ? number_in(parts[2]) : std::nullopt;
  if (!first || !last || !count || *count != std::floor(*count)) {
    return refused_plan(fmt::format("--over {}: expected FROM:TO:NUMBER", typed), std::string(over_remedy));
  }
  if (*count < 1.0 || (*count < 2.0 && *first != *last)) {
    return refused_plan(fmt::format("--over {}: an empty range: {} values from {} to {}", typed, *count, *first, *last),
                        "at least 2 values, both ends among them");
  }
  if (*count > static_cast<double>(unconfirmed_runs)) {
    return refused_plan(fmt::format("--over {}: more than {} values", typed, unconfirmed_runs), "ask for fewer");
  }
  std::vector<std::string> values;
  for (double i = 0.0; i < *count; i += 1.0) {
    // As numpy.linspace has it, to the last bit.
    const double step = *count > 1.0 ? (*last - *first) / (*count - 1.0) : 0.0;
    values.push_back(fmt::format("{}", i + 1.0 == *count ? *last : i * step + *first));
  }
  return values;
}

Expected<std::vector<std::string>> listed_values(const std::string& typed, std::string_view text) {
  std::vector<std::string> values;
  for (const auto piece : split(text, ',')) {
    const auto part = trimmed(piece);
    if (part.empty()) return refused_plan(fmt::format("--over {}: an empty value", typed), std::string(over_remedy));
    values.emplace_back(part);
  }
  return values;
}

/// NAME and what stands behind the equal sign.
Expected<std::pair<std::string, std::string_view>> name_and_rest(std::string_view option, const std::string& typed,
                                                                 std::string_view remedy) {
  const auto equal = typed.find('=');
  const auto name = trimmed(std::string_view(typed).substr(0, std::min(equal, typed.size())));
  const auto rest =
      equal == std::string::npos ? std::string_view() : trimmed(std::string_view(typed).substr(equal + 1));
  if (name.empty() || rest.empty()) {
    return refused_plan(fmt::format("{} {}: expected NAME=…", option, typed), std::string(remedy));
  }
  return std::pair{std::string(name), rest};
}

}  // namespace

bool is_list_of_others(std::string_view piece) {
  if (piece.starts_with('[') || piece.starts_with('{') || piece.ends_with(']') || piece.ends_with('}')) return true;
  const auto dots = piece.find("..");
  if (dots != std::string_view::npos) return number_in(piece.substr(0, dots)) && number_in(piece.substr(dots + 2));
  const auto numbers = split(piece, ' ');
  return numbers.size() > 1 && std::all_of(numbers.begin(), numbers.end(),
                                           [](std::string_view number) { return number.empty() || number_in(number); });
}

/// Fills a plan from what was typed.
class PlanReader {
 public:
  Expected<void> add_axis(const std::string& typed) {
    const auto parts = name_and_rest("--over", typed, over_remedy);
    if (!parts) return tl::unexpected(parts.error());
    const auto open = parts->second.find('(');
    if (open != std::string_view::npos && kind_named(trimmed(parts->second.substr(0, open)))) {
      return refused_plan(fmt::format("--over {}: expected values, found a distribution", typed),
                          fmt::format("--sample \"{}\" --runs 100", typed));
    }
    const bool is_range = parts->second.find(':') != std::string_view::npos;
    auto values = is_range ? range_values(typed, parts->second) : listed_values(typed, parts->second);
    if (!values) return tl::unexpected(values.error());
    plan_.axes_.push_back({std::move(*values)});
    return add_name("--over", parts->first);
  }

  Expected<void> add_sample(const std::string& typed) {
    const auto parts = name_and_rest("--sample", typed, sample_remedy);
    if (!parts) return tl::unexpected(parts.error());
    const auto text = parts->second;
    const auto open = text.find('(');
    if (open == std::string_view::npos || !text.ends_with(')')) {
      return refused_plan(fmt::format("--sample {}: expected a distribution", typed), std::string(sample_remedy));
    }
    const auto word = std::string(trimmed(text.substr(0, open)));
    const auto numbers = split(text.substr(open + 1, text.size() - open - 2), ',');
    const auto first = number_in(numbers.front());
    const auto second = numbers.size() == 2 ? number_in(numbers[1]) : std::nullopt;
    const auto kind = kind_named(word);
    if (!kind) {
      return refused_plan(fmt::format("--sample {}: unknown distribution '{}'", typed, word),
                          suggest_word(word, {"normal", "uniform", "lognormal"}));
    }
    if (!first || !second) {
      return refused_plan(fmt::format("--sample {}: {} has two numbers", typed, word), std::string(sample_remedy));
    }
    const double a = first.value_or(0.0), b = second.value_or(0.0);  // there are both
    const bool fits = *kind == SweepPlan::Kind::uniform ? a < b : b > 0.0;
    if (!fits) {
      return refused_plan(fmt::format("--sample {}: {}", typed,
                                      *kind == SweepPlan::Kind::uniform ? "the lower end must be below the upper one"
                                                                        : "the standard deviation must be > 0"),
                          std::string(sample_remedy));
    }
    plan_.distributions_.push_back({*kind, a, b});
    return add_name("--sample", parts->first);
  }

  Expected<SweepPlan> finish(const SweepRequest& request) && {
    if (plan_.names_.empty()) return refused_plan("nothing is changed from run to run", std::string(over_remedy));
    if (!plan_.distributions_.empty() && !request.runs) {
      return refused_plan("--sample needs the number of runs", "for example --runs 1000");
    }
    if (request.runs && plan_.distributions_.empty()) {
      return refused_plan("--runs is the number of samples, and nothing is sampled", std::string(sample_remedy));
    }
    if (request.runs && *request.runs < 1) {
      return refused_plan(fmt::format("--runs {}: at least 1 run is expected", *request.runs),
                          "for example --runs 1000");
    }
    plan_.seed_ = request.seed;
    plan_.paired_ = request.paired;
    plan_.samples_ = request.runs ? static_cast<std::size_t>(*request.runs) : 1;
    double runs = static_cast<double>(plan_.samples_);
    for (const auto& axis : plan_.axes_) {
      if (plan_.paired_ && axis.values.size() != plan_.axes_.front().values.size()) {
        return refused_plan(
            fmt::format("--zip: {} has {} values, {} has {}", plan_.names_.front(), plan_.axes_.front().values.size(),
                        plan_.names_[static_cast<std::size_t>(&axis - plan_.axes_.data())], axis.values.size()),
            "pairs need as many values of each; without --zip they make a grid");
      }
      if (!plan_.paired_ || &axis == plan_.axes_.data()) runs *= static_cast<double>(axis.values.size());
    }
    if (runs > static_cast<double>(unconfirmed_runs) && (!request.confirmed || runs > 1e12)) {
      return refused_plan(fmt::format("these are {:.0f} runs, more than {}", runs, unconfirmed_runs),
                          "--yes, if that is meant");
    }
    plan_.runs_ = static_cast<std::size_t>(runs);
    return std::move(plan_);
  }

 private:
  static std::optional<SweepPlan::Kind> kind_named(std::string_view word) {
    if (word == "normal") return SweepPlan::Kind::normal;
    if (word == "uniform") return SweepPlan::Kind::uniform;
    if (word == "lognormal") return SweepPlan::Kind::lognormal;
    return std::nullopt;
  }

  Expected<void> add_name(std::string_view option, const std::string& name) {
    if (contains(plan_.names_, name)) {
      return refused_plan(fmt::format("{}: '{}' is changed twice", option, name),
                          "give every name one range or distribution");
    }
    plan_.names_.push_back(name);
    return {};
  }

  SweepPlan plan_;
};

Expected<SweepPlan> SweepPlan::make(const SweepRequest& request) {
  PlanReader reader;
  for (const auto& typed : request.over) {
    if (auto done = reader.add_axis(typed); !done) return tl::unexpected(done.error());
  }
  for (const auto& typed : request.samples) {
    if (auto done = reader.add_sample(typed); !done) return tl::unexpected(done.error());
  }
  return std::move(reader).finish(request);
}

std::vector<std::string> SweepPlan::values(std::size_t run) const {
  std::vector<std::string> values(names_.size());
  std::size_t point = run / samples_;
  for (std::size_t k = axes_.size(); k-- > 0;) {
    const auto& axis = axes_[k].values;
    values[k] = axis[point % axis.size()];
    if (!paired_) point /= axis.size();
  }
  for (std::size_t k = 0; k < distributions_.size(); ++k) {
    const auto& distribution = distributions_[k];
    const double p = pipeline::uniform_number(seed_, run, static_cast<std::uint32_t>(k));
    const double a = distribution.first, b = distribution.second;
    const double value = distribution.kind == Kind::uniform     ? a + (b - a) * p
                         : distribution.kind == Kind::lognormal ? std::exp(a + b * pipeline::normal_quantile(p))
                                                                : a + b * pipeline::normal_quantile(p);
    values[axes_.size() + k] = fmt::format("{}", value);
  }
  return values;
}

}  // namespace saltus::frontend
