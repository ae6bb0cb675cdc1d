// The two forms of a system without nesting.
#pragma once

#include "saltus/reformulation/groups_internal.hpp"
#include "saltus/reformulation/sizes.hpp"

namespace saltus::reformulation {

/// Holds a Dcs and its sizes, filled by one of the forms.
struct Reformulated {
  Dcs dcs;
  Sizes sizes;
};

/// Holds selections and indicators while they are collected.
struct Collected {
  std::vector<SXElem> selection, indicator;
};

/// Adds one Stewart part of all indicators of a group of modes.
void add_indicator_part(const IndicatorPart& part, const model::System& system, Collected& collected,
                        Reformulated& result);
void add_group(GroupSizes group, Sizes& sizes);
[[nodiscard]] std::vector<std::string> names_of(const FieldGroup& group, const Unnested& unnested);

/// Makes parts, f, lifted and surface_alpha of `result`.
[[nodiscard]] Collected fill_step_form(const model::System& system, const Unnested& unnested,
                                       std::optional<int> lifting, Reformulated& result);
/// Makes the same in Stewart's form; products of alphas in outputs become sums of theta there.
[[nodiscard]] Expected<Collected> fill_stewart_form(const model::System& system, Unnested& unnested,
                                                    Reformulated& result);

[[nodiscard]] Expected<Reformulated> reformulated(const model::System& system, const ReformulationOptions& options);

}  // namespace saltus::reformulation
