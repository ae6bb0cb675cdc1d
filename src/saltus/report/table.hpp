// A result as a short readable table for a terminal.
#pragma once

#include <string>

#include "saltus/result/result.hpp"

namespace saltus::report {

/// Method, status, end state, event list (first and last ten, with the count), statistics; of a comparison a row for
/// every run, of an order study one for every scheme.
[[nodiscard]] std::string to_table(const result::Result& result);

}  // namespace saltus::report
