#include "saltus/evaluation/native_code.hpp"

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <dlfcn.h>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <spawn.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves the declaration to the program

namespace saltus::evaluation {
namespace {

namespace fs = std::filesystem;

/// What the machine code depends on besides the source: part of the content that is hashed and compared.
const std::vector<std::string>& compiler_arguments() {
  // No contraction and no fast math: the same roundings as the interpreter. Functions of the library call each other
  // without a table. Nothing is read or written two components at a time: the Runge-Kutta steps, which write and read
  // single ones, would wait for that.
  static const std::vector<std::string> arguments{"-O3",
                                                  "-march=native",
                                                  "-ffp-contract=off",
                                                  "-fno-math-errno",
                                                  "-fno-tree-slp-vectorize",
                                                  "-fno-semantic-interposition",
                                                  "-fPIC",
                                                  "-shared",
                                                  "-x",
                                                  "c"};
  return arguments;
}

std::string compiler() {
  const char* chosen = std::getenv("CC");
  return chosen != nullptr && *chosen != '\0' ? chosen : "cc";
}

/// The machine's processor: a cache folder may be shared between machines.
std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("flags", 0) == 0) return line;
  }
  return {};
}

std::string content_of(const std::string& source) {
  std::string content = "/* " + compiler();
  for (const auto& argument : compiler_arguments()) content += " " + argument;
  return content + "\n   " + processor() + " */\n" + source;
}

/// FNV-1a, 64 bits: a file name, no more; equality is decided by comparing the contents.
std::uint64_t hash_of(const std::string& content) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : content) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

std::optional<std::string> text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

Error not_available(std::string message) {
  return {ErrorCode::not_available,
          std::move(message),
          "install a C compiler (on Debian: apt install gcc), or use native = \"off\"",
          {},
          {}};
}

/// Runs the compiler; its messages go to `log`. Returns whether it succeeded.
bool run_compiler(const std::vector<std::string>& command, const fs::path& log) {
  std::vector<char*> arguments;
  for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return false;
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return false;
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

fs::path library_file(const fs::path& folder, const std::string& content) {
  return folder / fmt::format("{:016x}.so", hash_of(content));
}

}  // namespace

void* NativeLibrary::symbol(const std::string& name) const { return dlsym(handle_.get(), name.c_str()); }

std::optional<NativeLibrary> open_library(const fs::path& file) {
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) return std::nullopt;
  return NativeLibrary(std::shared_ptr<void>(handle, [](void* library) { dlclose(library); }));
}

std::optional<fs::path> cache_folder() {
  const auto variable = [](const char* name) -> std::optional<fs::path> {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') return std::nullopt;
    return fs::path(value);
  };
  if (const auto own = variable("SALTUS_CACHE")) return own;
  if (const auto cache = variable("XDG_CACHE_HOME")) return *cache / "saltus";
  if (const auto home = variable("HOME")) return *home / ".cache" / "saltus";
  return std::nullopt;
}

std::optional<NativeLibrary> find_native(const std::string& source) {
  const auto folder = cache_folder();
  if (!folder) return std::nullopt;
  const std::string content = content_of(source);
  const fs::path library = library_file(*folder, content);
  if (text_of(fs::path(library).replace_extension(".c")) != content) return std::nullopt;
  return open_library(library);
}

Expected<NativeLibrary> compile_native(const std::string& source) {
  const auto folder = cache_folder();
  if (!folder)
    return tl::unexpected(
        not_available("no cache folder for native code: none of SALTUS_CACHE, XDG_CACHE_HOME and HOME is set"));
  std::error_code failure;
  fs::create_directories(*folder, failure);
  const std::string content = content_of(source);
  const fs::path library = library_file(*folder, content);
  // Everything under names of this process first: renaming is what makes it visible.
  const std::string own = fmt::format("{}.{}", library.string(), getpid());
  const fs::path c_file = own + ".c";
  const fs::path log = own + ".log";
  {
    std::ofstream stream(c_file, std::ios::binary);
    stream << content;
    if (!stream.flush())
      return tl::unexpected(not_available("the cache folder " + folder->string() + " cannot be written"));
  }
  std::vector<std::string> command{compiler()};
  command.insert(command.end(), compiler_arguments().begin(), compiler_arguments().end());
  command.insert(command.end(), {c_file.string(), "-o", own, "-lm"});
  const bool compiled = run_compiler(command, log);
  const std::string words = text_of(log).value_or("");
  fs::remove(log, failure);
  if (!compiled) {
    fs::remove(c_file, failure);
    fs::remove(own, failure);
    return tl::unexpected(not_available(fmt::format("the C compiler '{}' did not compile the model functions{}{}",
                                                    compiler(), words.empty() ? "" : ": ", words.substr(0, 400))));
  }
  fs::rename(own, library, failure);
  if (!failure) fs::rename(c_file, fs::path(library).replace_extension(".c"), failure);
  auto opened = open_library(library);
  if (failure || !opened)
    return tl::unexpected(not_available("the compiled model functions cannot be loaded from " + library.string()));
  return std::move(*opened);
}

}  // namespace saltus::evaluation
