// Where the modes of a group hold, and whether that is everywhere exactly once.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/model/recognition/excluded_signs_internal.hpp"
#include "saltus/model/statement/modes_internal.hpp"

namespace saltus::model {
namespace {

/// More patterns than this are counted, not listed.
constexpr std::size_t listed_patterns = 10;

/// Sign patterns: the literals of a diagram that matter to a group, and the sets of patterns over them.
class Patterns {
 public:
  Patterns(const TruthDiagram& diagram, const std::vector<MetFunction>& functions, std::vector<int> literals)
      : diagram_(diagram), functions_(functions), literals_(std::move(literals)) {}

  /// "3 sign patterns: a > 0, b < 0; a < 0, b > 0" and one more.
  [[nodiscard]] std::string text(Truth set) const {
    const double number = count(set, 0);
    std::vector<std::string> shown;
    std::vector<bool> signs;
    collect(set, signs, shown);
    const bool all = static_cast<double>(shown.size()) >= number;
    return fmt::format("{} sign pattern{}: {}{}", number, number > 1.0 ? "s" : "", fmt::join(shown, "; "),
                       all ? "" : "; …");
  }

 private:
  [[nodiscard]] double count(Truth set, std::size_t level) const {
    if (set == TruthDiagram::constant_false()) return 0.0;
    if (level == literals_.size()) return 1.0;
    if (const auto known = counts_.find({set, level}); known != counts_.end()) return known->second;
    const double total = count(side(set, level, true), level + 1) + count(side(set, level, false), level + 1);
    counts_[{set, level}] = total;
    return total;
  }

  [[nodiscard]] Truth side(Truth set, std::size_t level, bool positive) const {
    const auto& node = diagram_[set];
    if (set <= 1 || node.literal != literals_[level]) return set;
    return positive ? node.high : node.low;
  }

  void collect(Truth set, std::vector<bool>& signs, std::vector<std::string>& shown) const {
    if (set == TruthDiagram::constant_false() || shown.size() == listed_patterns) return;
    if (signs.size() == literals_.size()) {
      shown.push_back(pattern(signs));
      return;
    }
    for (const bool positive : {true, false}) {
      const Truth next = side(set, signs.size(), positive);
      signs.push_back(positive);
      collect(next, signs, shown);
      signs.pop_back();
    }
  }

  [[nodiscard]] std::string pattern(const std::vector<bool>& signs) const {
    std::vector<std::string> terms;
    for (std::size_t i = 0; i < signs.size(); ++i) {
      const auto& name = functions_[at(literals_[i])].name;
      terms.push_back(fmt::format("{} {} 0", name, signs[i] ? ">" : "<"));
    }
    return terms.empty() ? "everywhere" : fmt::format("{}", fmt::join(terms, ", "));
  }

  const TruthDiagram& diagram_;
  const std::vector<MetFunction>& functions_;
  std::vector<int> literals_;
  mutable std::map<std::pair<Truth, std::size_t>, double> counts_;
};

/// The regions of one group, step by step.
class Cover {
 public:
  Cover(Recognition& recognition, const ModeGroupStatement& group) : recognition_(recognition), group_(group) {}

  [[nodiscard]] Expected<Regions> run() {
    for (const auto step : {&Cover::read_conditions, &Cover::exclude_impossible, &Cover::join, &Cover::close}) {
      if (auto error = (this->*step)()) return tl::unexpected(*error);
      if (regions_.diagram.overflowed()) return tl::unexpected(too_large());
    }
    for (const Truth truth : regions_.truth) {
      regions_.impossible.push_back(diagram().conjunction(truth, possible_) == TruthDiagram::constant_false());
    }
    return std::move(regions_);
  }

 private:
  TruthDiagram& diagram() { return regions_.diagram; }

  std::optional<Error> read_conditions() {
    for (std::size_t i = 0; i < group_.modes.size(); ++i) {
      regions_.truth.push_back(TruthDiagram::constant_false());
      const auto& mode = group_.modes[i];
      if (!mode.when) {
        if (otherwise_) return at(i, "the group has two modes 'otherwise'", "keep one of them");
        otherwise_ = i;
        continue;
      }
      const auto truth = recognition_.truth(diagram(), *mode.when);
      if (!truth) return with_location(truth.error(), mode.location);
      regions_.truth.back() = *truth;
    }
    literals_ = literals_in(regions_.truth);
    return std::nullopt;
  }

  [[nodiscard]] std::vector<int> literals_in(const std::vector<Truth>& roots) {
    std::set<int> literals;
    std::set<Truth> seen;
    std::vector<Truth> open = roots;
    while (!open.empty()) {
      const Truth current = open.back();
      open.pop_back();
      if (current <= 1 || !seen.insert(current).second) continue;
      literals.insert(diagram()[current].literal);
      open.insert(open.end(), {diagram()[current].low, diagram()[current].high});
    }
    return {literals.begin(), literals.end()};
  }

  std::optional<Error> exclude_impossible() {
    const auto& functions = recognition_.functions();
    for (const auto& pair : excluded_signs(recognition_.graph.tape(), functions, literals_)) {
      const auto &a = functions[saltus::at(pair.a)], &b = functions[saltus::at(pair.b)];
      recognition_.note({.kind = Decision::Kind::excluded, .node = a.psi_node, .other = b.psi_node},
                        [&] { return fmt::format("'{}' and '{}' exclude signs of each other", a.name, b.name); });
      const Truth both =
          diagram().conjunction(signed_literal(pair.a, pair.a_holds), signed_literal(pair.b, pair.b_holds));
      possible_ = diagram().conjunction(possible_, diagram().negation(both));
    }
    return std::nullopt;
  }

  Truth signed_literal(int literal, bool positive) {
    const Truth truth = diagram().literal(literal);
    return positive ? truth : diagram().negation(truth);
  }

  /// The union of the regions, which must not overlap.
  std::optional<Error> join() {
    for (std::size_t i = 0; i < group_.modes.size(); ++i) {
      const Truth here = diagram().conjunction(regions_.truth[i], possible_);
      const Truth twice = diagram().conjunction(here, covered_);
      if (diagram().overflowed()) return std::nullopt;
      if (twice != TruthDiagram::constant_false()) return covered_twice(i, twice);
      covered_ = diagram().disjunction(covered_, regions_.truth[i]);
    }
    return std::nullopt;
  }

  Error covered_twice(std::size_t mode, Truth twice) {
    std::vector<std::string> others;
    for (std::size_t i = 0; i < mode; ++i) {
      if (diagram().conjunction(regions_.truth[i], twice) != TruthDiagram::constant_false()) others.push_back(title(i));
    }
    return at(mode,
              fmt::format("{} overlaps {}: both hold for {}", title(mode), fmt::join(others, " and "), patterns(twice)),
              "restrict one of the conditions; every sign pattern belongs to exactly one mode of a group");
  }

  /// What is left belongs to `otherwise`, or nothing may be left.
  std::optional<Error> close() {
    const Truth rest = diagram().negation(covered_);
    const Truth missing = diagram().conjunction(rest, possible_);
    if (diagram().overflowed()) return std::nullopt;
    const bool complete = missing == TruthDiagram::constant_false();
    if (!otherwise_ && complete) return std::nullopt;
    if (!otherwise_) {
      return at(group_.modes.size() - 1, fmt::format("the modes{} leave uncovered {}", of_group(), patterns(missing)),
                "extend a condition, or add a mode with when = \"otherwise\"");
    }
    if (complete) {
      return at(*otherwise_,
                fmt::format("nothing is left for 'otherwise': the other modes{} cover everything", of_group()),
                "remove this mode, or restrict another one");
    }
    regions_.truth[*otherwise_] = rest;
    return std::nullopt;
  }

  [[nodiscard]] std::string patterns(Truth set) {
    return Patterns(diagram(), recognition_.functions(), literals_).text(set);
  }

  [[nodiscard]] std::string of_group() const {
    return group_.name.empty() ? "" : fmt::format(" of group '{}'", group_.name);
  }

  [[nodiscard]] std::string title(std::size_t mode) const {
    const int line = group_.modes[mode].location.line;
    return line > 0 ? fmt::format("the mode in line {}", line) : fmt::format("mode {}{}", mode + 1, of_group());
  }

  [[nodiscard]] Error at(std::size_t mode, std::string message, std::string remedy) const {
    return {ErrorCode::invalid_model, std::move(message), std::move(remedy), group_.modes[mode].location, {}};
  }

  [[nodiscard]] Error too_large() const {
    return at(0, fmt::format("the conditions of the modes{} are too large a set of sign patterns", of_group()),
              "split the group into independent ones (group = \"…\"), whose right-hand sides are summed");
  }

  Recognition& recognition_;
  const ModeGroupStatement& group_;
  Regions regions_;
  std::vector<int> literals_;
  std::optional<std::size_t> otherwise_;
  Truth possible_ = TruthDiagram::constant_true();
  Truth covered_ = TruthDiagram::constant_false();
};

}  // namespace

Expected<Regions> regions_of(Recognition& recognition, const ModeGroupStatement& group) {
  return Cover(recognition, group).run();
}

}  // namespace saltus::model
