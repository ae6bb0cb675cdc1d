// All mistakes of a description at once, for whoever reads them all.
#pragma once

#include <vector>

#include "saltus/model/description.hpp"

namespace saltus::model {

/// Returns what build() would refuse, and what it would refuse next were that put right. A name whose meaning could not
/// be worked out says nothing about the expressions that use it. Trees may be expression::unreadable, of which nothing
/// is told: whoever read them has. Empty for a description that build() takes.
/// @param is_whole  whether all that was written is stated; else nothing is told of what seems to be absent
[[nodiscard]] std::vector<Error> find_mistakes(const Description& description, bool is_whole = true);

}  // namespace saltus::model
