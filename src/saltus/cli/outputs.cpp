#include "saltus/cli/outputs.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "saltus/cli/catalogue.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/json_result.hpp"
#include "saltus/report/html.hpp"

namespace saltus::cli {
namespace {

namespace fs = std::filesystem;

Error refused(const std::string& option, const std::string& file, std::string message, std::string remedy) {
  return {ErrorCode::io_failure, fmt::format("{} {}: {}", option, file, message), std::move(remedy), {}, {}};
}

/// The same for every spelling of one file and every link to it.
fs::path identity(const fs::path& path) {
  std::error_code failed;
  auto canonical = fs::weakly_canonical(fs::absolute(io::target_of(path), failed), failed);
  return failed ? path.lexically_normal() : canonical;
}

struct Output {
  std::string option;
  std::string file;
  std::vector<std::string> suffixes;
};

Expected<void> check(const Output& output, std::set<fs::path>& taken) {
  const auto suffix = fs::path(output.file).extension().string();
  bool known = false;
  for (const auto& candidate : output.suffixes) known = known || suffix == candidate;
  if (!known) {
    return tl::unexpected(refused(output.option, output.file,
                                  fmt::format("the name must end in {}", fmt::join(output.suffixes, " or ")),
                                  "the suffix says what is written"));
  }
  if (!taken.insert(identity(output.file)).second) {
    return tl::unexpected(refused(output.option, output.file, "this file is named twice, or is the input",
                                  "give every output its own file"));
  }
  return io::check_writable(output.file);
}

}  // namespace

Expected<Outputs> Outputs::make(const std::vector<std::string>& files, const std::string& report,
                                const std::string& input, const std::vector<std::string>& suffixes) {
  std::set<fs::path> taken{identity(input)};
  std::vector<Output> wanted;
  for (const auto& file : files) wanted.push_back({"--out", file, suffixes});
  if (!report.empty()) wanted.push_back({"--report", report, {".html", ".htm"}});
  for (const auto& output : wanted) {
    if (auto writable = check(output, taken); !writable) return tl::unexpected(writable.error());
  }
  Outputs outputs;
  outputs.files_ = files;
  outputs.report_ = report;
  if (!report.empty()) {
    auto plotly = plotly_source();
    if (!plotly) return tl::unexpected(with_context(plotly.error(), fmt::format("for --report {}", report)));
    outputs.plotly_ = std::move(*plotly);
  }
  return outputs;
}

bool Outputs::show_surfaces() const {
  return !report_.empty() || std::any_of(files_.begin(), files_.end(),
                                         [](const std::string& file) { return fs::path(file).extension() != ".csv"; });
}

Expected<void> Outputs::write(const result::Result& result, const std::vector<report::Overlay>& overlays) const {
  Expected<void> outcome;
  const auto put = [&](const std::string& file, const std::string& content) {
    auto written = io::write_file(file, content);
    if (!written && outcome) outcome = std::move(written);
  };
  for (const auto& file : files_)
    put(file, fs::path(file).extension() == ".csv" ? io::to_csv(result) : io::to_json(result));
  if (!report_.empty()) put(report_, report::to_html(result, plotly_, overlays));
  return outcome;
}

}  // namespace saltus::cli
