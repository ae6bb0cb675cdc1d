// (22) of [nurkanovic2024], with the multipliers of the regions eliminated or as short products of lifted variables.
#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/reformulation/forms_internal.hpp"
#include "saltus/reformulation/lifting.hpp"

namespace saltus::reformulation {
namespace {

/// Whether the fields at alpha in {0, 1} say everything about f.
bool is_interpolated(const model::System& system) {
  return system.inclusion == model::Inclusion::filippov || system.inclusion_differences.empty();
}

class StepForm {
 public:
  StepForm(const model::System& system, const Unnested& unnested, std::optional<int> lifting, Reformulated& result)
      : system_(system), unnested_(unnested), lifting_(lifting), result_(result) {}

  Collected run() {
    Collected collected{unnested_.surface_symbols, {}};
    for (const auto& surface : unnested_.surfaces) collected.indicator.push_back(entry(surface.psi));
    const auto count = static_cast<int>(collected.selection.size());
    DcsPart part{.form = Form::step, .first = 0, .count = count};
    for (int j = 0; j < count; ++j) part.surfaces.push_back(j);
    if (count > 0) result_.dcs.parts.push_back(std::move(part));
    result_.dcs.surface_alpha = column(unnested_.surface_symbols);
    take_groups();
    for (const auto& indicators : unnested_.indicator_parts)
      add_indicator_part(indicators, system_, collected, result_);
    return collected;
  }

 private:
  void take_groups() {
    const FieldGroups groups = additive_groups(unnested_);
    std::vector<SXElem> f = groups.constant;
    bool lifted = false;
    for (const auto& group : groups.groups) {
      if (group.surfaces.empty()) {
        add_terms(group, f);
        continue;
      }
      Counts counts;
      counts.alpha = static_cast<int>(group.surfaces.size());
      if (group.terms.empty() || counts.alpha > most_surfaces || !group.indicator_parts.empty()) {
        add_terms(group, f);
      } else {
        const GroupRegions regions = regions_of(group, unnested_, system_);
        counts.theta = static_cast<int>(regions.fields.size());
        const bool lifts = lifting_ && counts.alpha > *lifting_ && is_interpolated(system_);
        counts.beta = lifts ? lift_group(group, regions, f) : 0;
        if (!lifts) add_terms(group, f);
        lifted = lifted || lifts;
      }
      counts.algebraic = counts.theta + 3 * counts.alpha + counts.beta;
      counts.complementarities = 2 * counts.alpha;
      counts.equations = counts.alpha + counts.beta + counts.theta;
      add_group({names_of(group, unnested_), Form::step, counts}, result_.sizes);
    }
    // Where nothing is lifted, f stays as it was written.
    result_.dcs.f = lifted ? column(f) : unnested_.f;
    result_.dcs.lifted = column(beta_);
    result_.dcs.lifting = column(equations_);
  }

  static void add_terms(const FieldGroup& group, std::vector<SXElem>& f) {
    for (const auto& term : group.terms) f[at(term.state)] += term.value;
  }

  [[nodiscard]] SXElem value_of(const LiftedProduct& product, const FieldGroup& group, std::size_t first) const {
    SXElem value = product.beta < 0 ? SXElem(1.0) : beta_[first + at(product.beta)];
    for (const StepFactor& factor : product.factors) {
      const SXElem& alpha = unnested_.surface_symbols[at(group.surfaces[at(factor.alpha)])];
      const SXElem one = factor.complement ? 1.0 - alpha : alpha;
      value = value.is_one() ? one : value * one;
    }
    return value;
  }

  /// @return how many variables the group's part of f needs
  int lift_group(const FieldGroup& group, const GroupRegions& regions, std::vector<SXElem>& f) {
    const Lifting lifted = lift(regions.signs, *lifting_);
    const std::size_t first = beta_.size();
    for (const LiftedProduct& product : lifted.beta) {
      const SXElem value = value_of(product, group, first);
      beta_.push_back(SXElem::sym(fmt::format("beta{}", beta_.size())));
      equations_.push_back(beta_.back() - value);
    }
    std::vector<SXElem> theta(regions.fields.size(), SXElem(0.0));
    for (std::size_t row = 0; row < regions.field_of.size(); ++row) {
      theta[at(regions.field_of[row])] += value_of(lifted.theta[row], group, first);
    }
    for (std::size_t i = 0; i < regions.fields.size(); ++i) {
      const auto field = entries(regions.fields[i]);
      for (std::size_t k = 0; k < field.size(); ++k) f[k] += weighted(theta[i], field[k], system_.p);
    }
    return static_cast<int>(lifted.beta.size());
  }

  const model::System& system_;
  const Unnested& unnested_;
  std::optional<int> lifting_;
  Reformulated& result_;
  std::vector<SXElem> beta_, equations_;
};

}  // namespace

Collected fill_step_form(const model::System& system, const Unnested& unnested, std::optional<int> lifting,
                         Reformulated& result) {
  return StepForm(system, unnested, lifting, result).run();
}

}  // namespace saltus::reformulation
