#include "saltus/evaluation/native_job.hpp"

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
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

namespace files = std::filesystem;

/// Characters from which a source is straight lines without loops, in many functions. The compiler then takes six
/// tenths of the time without its search for stores and loads in vain, and the code is as fast (a ladder of 1000
/// stages, 606 kB: 4.4 s instead of 7.6).
constexpr std::size_t large_source = 200000;

/// What the machine code depends on besides the source: part of the content that is hashed and compared.
std::vector<std::string> compiler_arguments(const std::string& source) {
  std::vector<std::string> arguments{"-O3"};
  if (source.size() >= large_source) arguments = {"-O1", "-fno-tree-dse", "-fno-tree-fre"};
  // No contraction and no fast math: the same roundings as the interpreter. Functions of the library call each other
  // without a table. Nothing is read or written two components at a time: the Runge-Kutta steps, which write and read
  // single ones, would wait for that.
  for (const char* argument : {"-march=native", "-ffp-contract=off", "-fno-math-errno", "-fno-tree-slp-vectorize",
                               "-fno-semantic-interposition", "-fPIC", "-shared", "-x", "c"}) {
    arguments.emplace_back(argument);
  }
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

/// FNV-1a, 64 bits: a file name, no more; equality is decided by comparing the contents.
std::uint64_t hash_of(const std::string& content) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : content) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

Error no_native_code(std::string message) {
  return {ErrorCode::not_available,
          std::move(message),
          "install a C compiler (on Debian: apt install gcc), or use native = \"off\"",
          {},
          {}};
}

std::string words_in(const files::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return {};
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

/// Runs the compiler, in a process group of its own; its messages go to `log`. Returns its process, or -1.
pid_t start_compiler(const std::vector<std::string>& command, const files::path& log) {
  std::vector<char*> arguments;
  for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t child = -1;
  const int failed = posix_spawnp(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return failed != 0 ? -1 : child;
}

}  // namespace

std::string native_content(const std::string& source) {
  std::string content = "/* " + compiler();
  for (const auto& argument : compiler_arguments(source)) content += " " + argument;
  return content + "\n   " + processor() + " */\n" + source;
}

files::path native_library_file(const files::path& folder, const std::string& content) {
  return folder / fmt::format("{:016x}.so", hash_of(content));
}

Expected<std::unique_ptr<NativeJob>> NativeJob::start(const std::string& source) {
  const auto folder = cache_folder();
  if (!folder)
    return tl::unexpected(
        no_native_code("no cache folder for native code: none of SALTUS_CACHE, XDG_CACHE_HOME and HOME is set"));
  std::error_code failure;
  files::create_directories(*folder, failure);
  const std::string content = native_content(source);
  auto job = std::unique_ptr<NativeJob>(new NativeJob);
  job->library_ = native_library_file(*folder, content);
  // Everything under names of this job first: renaming is what makes it visible.
  job->own_ = fmt::format("{}.{}.{}", job->library_.string(), getpid(), fmt::ptr(job.get()));
  job->c_file_ = job->own_.string() + ".c";
  job->log_ = job->own_.string() + ".log";
  {
    std::ofstream stream(job->c_file_, std::ios::binary);
    stream << content;
    if (!stream.flush())
      return tl::unexpected(no_native_code("the cache folder " + folder->string() + " cannot be written"));
  }
  std::vector<std::string> command{compiler()};
  const auto arguments = compiler_arguments(source);
  command.insert(command.end(), arguments.begin(), arguments.end());
  command.insert(command.end(), {job->c_file_.string(), "-o", job->own_.string(), "-lm"});
  job->child_ = start_compiler(command, job->log_);
  return job;
}

NativeJob::~NativeJob() {
  if (child_ >= 0) {
    kill(-child_, SIGKILL);
    take_status(0);
  }
  remove_files();
}

bool NativeJob::take_status(int options) {
  if (child_ < 0) return true;
  int status = 0;
  pid_t ended = 0;
  do {
    ended = waitpid(child_, &status, options);
  } while (ended < 0 && errno == EINTR);
  if (ended == 0) return false;
  succeeded_ = ended == child_ && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  child_ = -1;
  return true;
}

bool NativeJob::has_ended() { return take_status(WNOHANG); }

void NativeJob::remove_files() {
  std::error_code failure;
  for (const auto& file : {log_, c_file_, own_}) files::remove(file, failure);
}

Expected<NativeLibrary> NativeJob::finish() {
  take_status(0);
  const std::string words = words_in(log_);
  if (!succeeded_) {
    remove_files();
    return tl::unexpected(no_native_code(fmt::format("the C compiler '{}' did not compile the model functions{}{}",
                                                     compiler(), words.empty() ? "" : ": ", words.substr(0, 400))));
  }
  std::error_code failure;
  files::rename(own_, library_, failure);
  if (!failure) files::rename(c_file_, files::path(library_).replace_extension(".c"), failure);
  auto opened = open_library(library_);
  if (failure || !opened)
    return tl::unexpected(no_native_code("the compiled model functions cannot be loaded from " + library_.string()));
  return std::move(*opened);
}

}  // namespace saltus::evaluation
