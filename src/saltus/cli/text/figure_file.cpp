#include "saltus/cli/text/figure_file.hpp"

#include <cstdlib>
#include <filesystem>
#include <spawn.h>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "saltus/io/atomic_file.hpp"

extern char** environ;

namespace saltus::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* converter = "rsvg-convert";

/// Empty if no folder of $PATH has it.
std::string program_named(const std::string& name) {
  if (name.find('/') != std::string::npos) return ::access(name.c_str(), X_OK) == 0 ? name : std::string();
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    auto candidate = fs::path(folder) / name;
    if (::access(candidate.c_str(), X_OK) == 0) return candidate.string();
  }
  return {};
}

/// The number of the new process; 0 if it could not be started.
pid_t start(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> list;
  for (auto& word : words) list.push_back(word.data());
  list.push_back(nullptr);
  pid_t child = 0;
  return ::posix_spawn(&child, program.c_str(), nullptr, nullptr, list.data(), environ) == 0 ? child : 0;
}

/// Removes a folder with all that is in it when it goes.
struct Workplace {
  fs::path folder;
  Workplace() {
    std::string name = (fs::temp_directory_path() / "saltus-figure-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) folder = name;
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;
  ~Workplace() {
    std::error_code ignored;
    if (!folder.empty()) fs::remove_all(folder, ignored);
  }
};

Error failed(const std::string& file, std::string message, std::string remedy) {
  return {ErrorCode::io_failure, fmt::format("--figure {}: {}", file, message), std::move(remedy), {}, {}};
}

Expected<std::string> converted(const std::string& file, const std::string& svg) {
  const Workplace place;
  if (place.folder.empty()) return tl::unexpected(failed(file, "no temporary folder could be made", "set TMPDIR"));
  const auto from = place.folder / "figure.svg", to = place.folder / "figure.out";
  if (auto written = io::write_file(from, svg); !written) return tl::unexpected(written.error());
  const bool picture = fs::path(file).extension() == ".png";
  const pid_t child = start(program_named(converter), {"--format", picture ? "png" : "pdf", "--zoom",
                                                       picture ? "2" : "1", "--output", to.string(), from.string()});
  int state = 0;
  if (child == 0 || ::waitpid(child, &state, 0) != child || !WIFEXITED(state) || WEXITSTATUS(state) != 0)
    return tl::unexpected(failed(file, fmt::format("{} failed", converter), "write .svg instead"));
  return io::read_file(to);
}

}  // namespace

Expected<void> check_figure(const std::string& file) {
  const auto suffix = fs::path(file).extension().string();
  if (suffix != ".svg" && suffix != ".pdf" && suffix != ".png") {
    return tl::unexpected(failed(file, "the name must end in .svg, .pdf or .png", "the suffix says what is written"));
  }
  if (suffix != ".svg" && program_named(converter).empty()) {
    return tl::unexpected(failed(file,
                                 fmt::format("{} drawings need the program {}, which is not there", suffix, converter),
                                 "apt-get install librsvg2-bin, or write .svg"));
  }
  return io::check_writable(file);
}

Expected<void> write_figure(const std::string& file, const std::string& svg) {
  if (fs::path(file).extension() == ".svg") return io::write_file(file, svg);
  const auto bytes = converted(file, svg);
  if (!bytes) return tl::unexpected(bytes.error());
  return io::write_file(file, *bytes);
}

Expected<void> open_page(const std::string& page) {
  const char* chosen = std::getenv("BROWSER");
  const std::string program = program_named(chosen != nullptr && *chosen != '\0' ? chosen : "xdg-open");
  std::error_code ignored;
  if (program.empty() || start(program, {fs::absolute(page, ignored).string()}) == 0) {
    return tl::unexpected(Error{ErrorCode::io_failure,
                                fmt::format("--open: no program was found that shows {}", page),
                                "set BROWSER to one, or open the page yourself",
                                {},
                                {}});
  }
  return {};
}

}  // namespace saltus::cli
