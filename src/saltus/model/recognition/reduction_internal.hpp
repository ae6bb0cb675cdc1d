// The multi-affine interpolation of an expression in its alphas (Filippov's inclusion for f as a person writes it).
#pragma once

#include <set>
#include <string>
#include <vector>

#include "saltus/model/graph/sx_graph_internal.hpp"

namespace saltus::model {

/// Returns the alphas (by node) in which an expression is not affine as it is written, ascending. Decided on the form
/// of the expression: a product of two factors with the same alpha counts, whatever it simplifies to.
[[nodiscard]] std::vector<int> nonaffine_alphas(const Tape& tape, int node);

/// Replaces every additive term of the expression by its interpolation between alpha = 0 and 1 in those of the given
/// alphas in which it is not affine: f -> alpha f|1 + (1 - alpha) f|0.
/// @param alphas  nodes of the alphas that can take values between 0 and 1 where it matters
/// @param what    the expression is, for the error
/// @return the expression itself where nothing is to do; an error if a term needs more than 64 corners
[[nodiscard]] Expected<SXElem> interpolate(SxGraph& graph, int node, const std::set<int>& alphas,
                                           const std::string& what);

}  // namespace saltus::model
