// What a system says of a point where a run gets no further: words for messages.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace saltus::evaluation {

class ModelKernel;

/// Does what model::vanishing_norm does, with the values that a kernel has. Takes the symbolic lock.
[[nodiscard]] std::string vanishing_norm(const ModelKernel& kernel, double t, const std::vector<double>& x);

/// Does what model::find_indefinite_mass does, with the values that a kernel has.
[[nodiscard]] std::optional<std::string> find_indefinite_mass(const ModelKernel& kernel, const std::vector<double>& x);

}  // namespace saltus::evaluation
