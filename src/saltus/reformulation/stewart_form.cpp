// (28) of [nurkanovic2024]: sums of independent groups, each with the sign patterns of its switching functions.
#include <algorithm>
#include <unordered_set>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/reformulation/forms_internal.hpp"

namespace saltus::reformulation {
namespace {

Error refusal(std::string message) {
  return {ErrorCode::not_available, std::move(message), "use reformulation = \"step\"", {}, {}};
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 4;
  const std::size_t shown = std::min(names.size(), most);
  return fmt::format("{}{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                     names.size() > most ? ", …" : "");
}

class StewartForm {
 public:
  StewartForm(const model::System& system, Unnested& unnested, Reformulated& result)
      : system_(system), unnested_(unnested), result_(result), alpha_(unnested.surfaces.size()) {}

  Expected<Collected> run() {
    if (system_.inclusion == model::Inclusion::aizerman_pyatnitskii && !system_.inclusion_differences.empty()) {
      return tl::unexpected(
          refusal(fmt::format("Stewart's form mixes the fields of regions linearly, but with inclusion = "
                              "\"aizerman_pyatnitskii\" the selections enter the dynamics of {} nonlinearly",
                              listed(system_.inclusion_differences))));
    }
    const FieldGroups groups = additive_groups(unnested_);
    std::vector<SXElem> f = groups.constant;
    for (const auto& group : groups.groups) {
      if (auto error = find_problem(group)) return tl::unexpected(*error);
      if (group.surfaces.empty()) {
        for (const auto& term : group.terms) f[at(term.state)] += term.value;
      } else {
        add_patterns(group, f);
      }
    }
    for (const auto& part : unnested_.indicator_parts) add_indicator_part(part, system_, collected_, result_);
    result_.dcs.f = column(f);
    result_.dcs.surface_alpha = column(alpha_);
    return std::move(collected_);
  }

 private:
  [[nodiscard]] std::optional<Error> find_problem(const FieldGroup& group) const {
    const auto names = names_of(group, unnested_);
    if (!group.surfaces.empty() && !group.indicator_parts.empty()) {
      return refusal(
          fmt::format("Stewart's form needs independent groups, but regions by `indicator` occur in products with {}",
                      listed(names)));
    }
    if (names.size() > at(most_surfaces)) {
      return refusal(fmt::format(
          "Stewart's form has a multiplier for each of the 2^{} sign patterns of the switching functions that occur in "
          "common products ({}); at most {} functions are covered",
          names.size(), listed(names), most_surfaces));
    }
    return std::nullopt;
  }

  /// theta of every sign pattern, + before -, the last function fastest; g = -S psi.
  void add_patterns(const FieldGroup& group, std::vector<SXElem>& f) {
    const auto n = static_cast<int>(group.surfaces.size());
    const int rows = 1 << n;
    DcsPart part{.form = Form::stewart,
                 .first = static_cast<int>(collected_.selection.size()),
                 .count = rows,
                 .surfaces = group.surfaces};
    part.signs = linalg::IntMatrix(rows, n);
    std::vector<SXElem> theta;
    for (const int surface : group.surfaces) alpha_[at(surface)] = 0.0;
    for (int i = 0; i < rows; ++i) {
      theta.push_back(SXElem::sym(fmt::format("theta{}", part.first + i)));
      SXElem g = 0.0;
      for (int j = 0; j < n; ++j) {
        const int surface = group.surfaces[at(j)];
        const bool positive = (i >> (n - 1 - j) & 1) == 0;
        part.signs(i, j) = positive ? 1 : -1;
        const SXElem psi = entry(unnested_.surfaces[at(surface)].psi);
        g = positive ? g - psi : g + psi;
        if (positive) alpha_[at(surface)] += theta.back();
      }
      collected_.selection.push_back(theta.back());
      collected_.indicator.push_back(g);
    }
    for (const auto& term : group.terms) f[at(term.state)] += mean(term, part, theta);
    take_means_of_outputs(part, theta);
    result_.dcs.parts.push_back(std::move(part));
    Counts counts;
    counts.theta = rows;
    counts.algebraic = 2 * rows + 1;
    counts.complementarities = rows;
    counts.equations = rows + 1;
    add_group({names_of(group, unnested_), Form::stewart, counts}, result_.sizes);
  }

  /// A term has a value for each corner of its own selections; the patterns that agree with the corner share it.
  [[nodiscard]] SXElem mean(const FieldTerm& term, const DcsPart& part, const std::vector<SXElem>& theta) const {
    std::vector<int> columns;
    for (const int surface : term.surfaces) {
      columns.push_back(
          static_cast<int>(std::find(part.surfaces.begin(), part.surfaces.end(), surface) - part.surfaces.begin()));
    }
    const auto values = corner_values(term, unnested_);
    std::vector<SXElem> weights(values.size(), SXElem(0.0));
    for (int i = 0; i < part.count; ++i) {
      std::size_t corner = 0;
      for (std::size_t k = 0; k < columns.size(); ++k) {
        corner |= static_cast<std::size_t>(part.signs(i, columns[k]) > 0) << k;
      }
      weights[corner] += theta[at(i)];
    }
    SXElem sum = 0.0;
    for (std::size_t corner = 0; corner < values.size(); ++corner) {
      sum += weighted(weights[corner], values[corner], system_.p);
    }
    return sum;
  }

  /// A product of selections of a part is, like those in f, the weight of regions, not a product of their weights.
  void take_means_of_outputs(const DcsPart& part, const std::vector<SXElem>& theta) {
    std::unordered_set<const void*> symbols;
    for (const int surface : part.surfaces) symbols.insert(unnested_.surface_symbols[at(surface)].get());
    auto outputs = entries(unnested_.outputs);
    for (SXElem& output : outputs) {
      SXElem sum = 0.0;
      for (const SXElem& value : additive_terms(output, symbols)) {
        const FieldTerm term{.value = value, .surfaces = surfaces_in(value, part)};
        sum += term.surfaces.size() > 1 && is_multi_affine(term) ? mean(term, part, theta) : value;
      }
      output = sum;
    }
    unnested_.outputs = column(outputs);
  }

  [[nodiscard]] std::vector<int> surfaces_in(const SXElem& value, const DcsPart& part) const {
    std::vector<int> found;
    for (const int surface : part.surfaces) {
      if (SX::depends_on(SX(value), SX(unnested_.surface_symbols[at(surface)]))) found.push_back(surface);
    }
    return found;
  }

  [[nodiscard]] bool is_multi_affine(const FieldTerm& term) const {
    return std::all_of(term.surfaces.begin(), term.surfaces.end(), [&](int surface) {
      const SX alpha(unnested_.surface_symbols[at(surface)]);
      return !SX::depends_on(SX::jacobian(SX(term.value), alpha), alpha);
    });
  }

  const model::System& system_;
  Unnested& unnested_;
  Reformulated& result_;
  std::vector<SXElem> alpha_;
  Collected collected_;
};

}  // namespace

Expected<Collected> fill_stewart_form(const model::System& system, Unnested& unnested, Reformulated& result) {
  return StewartForm(system, unnested, result).run();
}

}  // namespace saltus::reformulation
