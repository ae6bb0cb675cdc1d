// Mistakes of entries of a description.
#pragma once

#include <string>

#include "saltus/model/description.hpp"
#include "saltus/model/statement/names_internal.hpp"

namespace saltus::model {

[[nodiscard]] Error not_settable(const Override& entry, const Meaning* meaning, const NameTable& names);
[[nodiscard]] Error no_such_state(const NamedExpression& entry, const Meaning* meaning, const NameTable& names);
[[nodiscard]] Error nothing_to_record(const NamedExpression& entry, const NameTable& names);
[[nodiscard]] Error a_condition(const NamedExpression& entry);
[[nodiscard]] Error moving_input(const std::string& name, const SourceLocation& location);
[[nodiscard]] Error no_such_control(const std::string& name, const SourceLocation& location, const NameTable& names);

}  // namespace saltus::model
