#include "saltus/model/places.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/model/system.hpp"

namespace saltus::model {
namespace {

Expected<std::size_t> place_named(const std::string& name, const std::vector<std::string>& names, const char* what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  Error error;
  error.code = ErrorCode::unknown_name;
  error.message = fmt::format("the system has no {} '{}'", what, name);
  error.remedy = names.empty() ? fmt::format("it has no {}s", what) : fmt::format("known: {}", fmt::join(names, ", "));
  return tl::unexpected(std::move(error));
}

}  // namespace

Expected<std::size_t> parameter_place(const System& system, const std::string& name) {
  return place_named(name, system.parameter_names, "parameter");
}

Expected<std::size_t> state_place(const System& system, const std::string& name) {
  return place_named(name, system.state_names, "state");
}

Expected<std::size_t> control_place(const System& system, const std::string& name) {
  return place_named(name, system.control_names, "control");
}

}  // namespace saltus::model
