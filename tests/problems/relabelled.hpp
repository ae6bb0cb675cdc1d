// The same model in other words: other names, orders, signs and units of its switching functions, another order of its
// states. Nothing of that is in the solution.
#pragma once

#include <string>
#include <vector>

#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/description.hpp"
#include "saltus/result/result.hpp"

namespace saltus::problems {

enum class Listing { as_written, reversed };

struct Relabelling {
  std::string name;
  double psi_factor = 1.0;  ///< of every switching function and indicator (these only if positive); not 0
  Listing surfaces = Listing::as_written;
  Listing states = Listing::as_written;
};

/// One by one, and all at once.
[[nodiscard]] const std::vector<Relabelling>& relabellings();

/// Every switching function gets a new name and the factor. What had a name keeps it as a definition, so that the
/// fields stay as they are written. Throws if the model cannot be built.
void relabel(io::ModelFile& file, const std::vector<model::Override>& overrides, const Relabelling& relabelling);

/// A result of the relabelled model in the words of the original: names `surfaces` and order, signs of modes, alpha.
/// Reasons and pictures of decisions stay.
[[nodiscard]] result::Result in_original_words(result::Result result, const Relabelling& relabelling,
                                               const std::vector<std::string>& surfaces);

}  // namespace saltus::problems
