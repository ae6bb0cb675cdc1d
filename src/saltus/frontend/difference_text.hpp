// What `saltus diff` prints.
#pragma once

#include <cstddef>
#include <string>

#include "saltus/result/difference.hpp"

namespace saltus::frontend {

/// Writes what differs, a line for each, and in the last line whether the results are the same to the tolerances.
/// @param states_of_model  how many states each result has at its end; rows may have fewer
[[nodiscard]] std::string difference_text(const result::Difference& difference, const result::Tolerances& tolerances,
                                          std::size_t states_of_model);

}  // namespace saltus::frontend
