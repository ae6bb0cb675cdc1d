// Files a run writes: checked before computing, written whole or not at all.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/cli/growing_outputs.hpp"
#include "saltus/cli/progress.hpp"
#include "saltus/report/overlay.hpp"
#include "saltus/result/result.hpp"

namespace saltus::cli {

enum class Written {
  all,
  interrupted,  ///< by Ctrl-C: of the file under way nothing is left, the ones before it are complete
};

/// Holds what was typed of files.
struct OutputNames {
  std::vector<std::string> files{};        ///< of --out; - is standard output
  std::string format{};                    ///< of --format, for standard output: a suffix without its point
  std::string report{};                    ///< of --report: .html; empty for none
  std::string report_option = "--report";  ///< what the user calls it
  std::vector<std::string> suffixes{};     ///< that files of --out may have: .json, .csv, .npz
};

/// Holds the outputs of one run; exists only if all of them can be written.
class Outputs {
 public:
  /// @param input     file that is read and must not be overwritten
  /// @return the outputs, or an error: a suffix or a format without meaning, a file twice, one that cannot be written,
  ///         plotly missing.
  [[nodiscard]] static Expected<Outputs> make(const OutputNames& names, const std::string& input);

  /// Returns whether any of them has the surfaces of the model in it.
  [[nodiscard]] bool show_surfaces() const;
  /// Returns whether standard output has one of them, and nothing else.
  [[nodiscard]] bool fill_standard_output() const;

  /// Returns these outputs as files that grow while a run goes on, maybe none; nullopt where one needs the whole
  /// result.
  /// @param events  of the table, at each end
  [[nodiscard]] std::optional<GrowingOutputs> growing(std::size_t events) const;
  /// Ends them as write() does.
  [[nodiscard]] Expected<Written> finish(GrowingOutputs& growing, const result::Result& rest, ShowProgress show) const;

  /// Writes all it can, with a line of progress, until Ctrl-C; returns the first failure.
  /// @param overlays  results that the page lays over this one
  [[nodiscard]] Expected<Written> write(const result::Result& result, ShowProgress show,
                                        const std::vector<report::Overlay>& overlays = {}) const;

 private:
  OutputNames names_;
  std::string plotly_;
};

}  // namespace saltus::cli
