#include "saltus/cli/outputs.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/docs_page.hpp"
#include "saltus/base/other_words.hpp"
#include "saltus/cli/interrupt.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/catalogue.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/json/json_result.hpp"
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

constexpr std::string_view standard_output = "-";

Expected<void> check_suffix(const Output& output) {
  const auto suffix = fs::path(output.file).extension().string();
  auto known = output.suffixes;
  if (contains(known, suffix)) return {};
  if (const auto csv = std::find(known.begin(), known.end(), ".csv"); csv != known.end())
    known.insert(csv + 1, ".events.csv");
  constexpr std::array<std::string_view, 5> of_python{".parquet", ".feather", ".mat", ".xlsx", ".h5"};
  const bool has_table = contains(known, std::string(".csv"));
  return tl::unexpected(
      refused(output.option, output.file, fmt::format("the name must end in {}", fmt::join(known, " or ")),
              has_table && contains(of_python, suffix)
                  ? fmt::format("the suffix says what is written; Python writes {} files of a result: see {}", suffix,
                                docs_page("howto", "write-parquet-matlab-or-excel-files"))
                  : "the suffix says what is written"));
}

Expected<void> check(const Output& output, std::set<fs::path>& taken) {
  if (auto known = check_suffix(output); !known) return known;
  if (!taken.insert(identity(output.file)).second) {
    return tl::unexpected(refused(output.option, output.file, "this file is named twice, or is the input",
                                  "give every output its own file"));
  }
  return io::check_writable(output.file);
}

/// Standard output: one result at most, of a format that files may have.
Expected<void> check_standard_output(const OutputNames& names) {
  const auto count = std::count(names.files.begin(), names.files.end(), standard_output);
  if (count > 1) {
    return tl::unexpected(refused("--out", "-", "standard output is named twice", "give every output its own file"));
  }
  if (names.format.empty()) return {};
  if (count == 0) {
    return tl::unexpected(
        refused("--format", names.format, "it is for --out -", "the suffix of a file says what is written"));
  }
  std::vector<std::string> known;
  for (const auto& suffix : names.suffixes) known.push_back(suffix.substr(1));
  if (contains(known, "csv")) known.emplace_back("events.csv");
  if (contains(known, names.format)) return {};
  return tl::unexpected(refused("--format", names.format, fmt::format("expected {}", fmt::join(known, " or ")),
                                suggest_word(names.format, known)));
}

/// Passes pieces on, shows how many bytes there are, and takes no more after Ctrl-C.
class WatchedWriting {
 public:
  WatchedWriting(const std::string& file, ShowProgress show) : file_(file), show_(show), line_(show) {}

  bool pass(std::string_view piece, io::Sink sink) {
    bytes_ += piece.size();
    if (interrupted()) return false;
    if (show_ != ShowProgress::never && note_.is_due(bytes_)) {
      line_.clear();
      note_.grows(file_);
    }
    line_.show([&] { return fmt::format("writing {}   {:.0f} MB", file_, static_cast<double>(bytes_) / 1e6); });
    return sink(piece);
  }
  void end() {
    line_.clear();
    if (show_ != ShowProgress::never) note_.end(file_, bytes_);
  }

 private:
  const std::string& file_;
  ShowProgress show_;
  ProgressLine line_;
  std::size_t bytes_ = 0;
  SizeNote note_;
};

Expected<void> write_one(const std::string& file, const std::string& format, const result::Result& result,
                         ShowProgress show) {
  WatchedWriting watched(file, show);
  const auto write_into = [&](std::string_view name, io::Sink sink) {
    return io::write_as(name, result, [&](std::string_view piece) { return watched.pass(piece, sink); });
  };
  Expected<void> written;
  if (file == standard_output) {
    static_cast<void>(write_into(format, [](std::string_view piece) {
      print(piece);
      return true;
    }));
  } else {
    written = io::stream_file(file, [&](io::Sink sink) { return write_into(file, sink); });
  }
  watched.end();
  return written;
}

/// Makes and writes a page, with a line of progress, until Ctrl-C.
/// @param again  Ctrl-C has ended the run
Expected<void> write_watched_page(const std::string& file, ShowProgress show, bool again,
                                  FunctionRef<std::string(const report::GoOn& go_on)> make) {
  if (again) print_error(fmt::format("writing {}; Ctrl-C once more leaves it out", file));
  ProgressLine line(show);
  const auto page = make([&] {
    line.show([&] { return fmt::format("writing {}", file); });
    return !interrupted();
  });
  line.clear();
  if (!interrupted()) return io::write_file(file, page);
  print_error(fmt::format("writing {} was interrupted; an earlier file of that name is as it was", file));
  return {};
}

}  // namespace

Expected<Outputs> Outputs::make(const OutputNames& names, const std::string& input) {
  std::set<fs::path> taken{identity(input)};
  if (auto fits = check_standard_output(names); !fits) return tl::unexpected(fits.error());
  std::vector<Output> wanted;
  for (const auto& file : names.files) {
    const bool to_standard_output = file == standard_output && !names.suffixes.empty();
    if (!to_standard_output) wanted.push_back({"--out", file, names.suffixes});
  }
  if (!names.report.empty()) wanted.push_back({names.report_option, names.report, {".html", ".htm"}});
  for (const auto& output : wanted) {
    if (auto writable = check(output, taken); !writable) return tl::unexpected(writable.error());
  }
  Outputs outputs;
  outputs.names_ = names;
  if (!names.report.empty()) {
    auto plotly = frontend::plotly_source();
    if (!plotly) return tl::unexpected(with_context(plotly.error(), fmt::format("for --report {}", names.report)));
    outputs.plotly_ = std::move(*plotly);
  }
  return outputs;
}

bool Outputs::show_surfaces() const {
  const auto& format = names_.format;
  return !names_.report.empty() || std::any_of(names_.files.begin(), names_.files.end(), [&](const auto& file) {
    return file == standard_output ? format.empty() || format == "json" : file.ends_with(".json");
  });
}

bool Outputs::fill_standard_output() const { return contains(names_.files, standard_output); }

std::optional<GrowingOutputs> Outputs::growing(std::size_t events) const {
  constexpr std::size_t most_events = 10000;
  if (!names_.report.empty() || events > most_events) return std::nullopt;
  return GrowingOutputs(names_.files, names_.format, events);
}

Expected<Written> Outputs::finish(GrowingOutputs& growing, const result::Result& rest, ShowProgress show) const {
  catch_interrupt();
  ProgressLine line(show);
  std::string stopped;
  auto written = growing.finish(rest, [&](const std::string& name, std::size_t bytes) {
    if (interrupted()) {
      stopped = name;
      return false;
    }
    line.show([&] { return fmt::format("writing {}   {:.0f} MB", name, static_cast<double>(bytes) / 1e6); });
    return true;
  });
  line.clear();
  if (!stopped.empty()) {
    print_error(fmt::format("writing {} was interrupted; an earlier file of that name is as it was", stopped));
    return Written::interrupted;
  }
  if (show != ShowProgress::never) growing.note_large_files();
  if (!written) return tl::unexpected(written.error());
  return Written::all;
}

Expected<Written> Outputs::write(const result::Result& result, ShowProgress show,
                                 const std::vector<report::Overlay>& overlays) const {
  const bool again = interrupted();
  catch_interrupt();  // anew: one that ended the run does not keep its result from being written
  Expected<void> outcome;
  const auto keep_first = [&](Expected<void> written) {
    if (!written && outcome) outcome = std::move(written);
  };
  for (const auto& file : names_.files) {
    auto written = write_one(file, names_.format, result, show);
    if (interrupted()) {
      print_error(fmt::format("writing {} was interrupted; an earlier file of that name is as it was", file));
      return Written::interrupted;
    }
    keep_first(std::move(written));
  }
  if (!names_.report.empty()) {
    auto written = write_watched_page(names_.report, show, again, [&](const report::GoOn& go_on) {
      return report::to_html(result, plotly_, overlays, go_on);
    });
    if (interrupted()) return Written::interrupted;
    keep_first(std::move(written));
  }
  if (!outcome) return tl::unexpected(outcome.error());
  return Written::all;
}

}  // namespace saltus::cli
