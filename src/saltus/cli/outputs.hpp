// Files a run writes: checked before computing, written whole or not at all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/report/overlay.hpp"
#include "saltus/result/result.hpp"

namespace saltus::cli {

/// The outputs of one run; exists only if all of them can be written.
class Outputs {
 public:
  /// @param files     of --out
  /// @param report    of --report: .html; empty for none
  /// @param input     file that is read and must not be overwritten
  /// @param suffixes  that files of --out may have: .json, .csv
  /// @return the outputs, or an error: a suffix without meaning, a file twice, one that cannot be written, plotly
  ///         missing.
  [[nodiscard]] static Expected<Outputs> make(const std::vector<std::string>& files, const std::string& report,
                                              const std::string& input, const std::vector<std::string>& suffixes = {});

  /// Whether any of them has the surfaces of the model in it.
  [[nodiscard]] bool show_surfaces() const;

  /// Writes all it can; returns the first failure.
  /// @param overlays  results that the page lays over this one
  [[nodiscard]] Expected<void> write(const result::Result& result,
                                     const std::vector<report::Overlay>& overlays = {}) const;

 private:
  std::vector<std::string> files_;
  std::string report_;
  std::string plotly_;
};

}  // namespace saltus::cli
