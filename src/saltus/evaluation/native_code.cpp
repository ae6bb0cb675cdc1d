#include "saltus/evaluation/native_code.hpp"

#include <cstdlib>
#include <dlfcn.h>
#include <fstream>
#include <iterator>

#include "saltus/evaluation/native_job.hpp"

namespace saltus::evaluation {
namespace {

namespace fs = std::filesystem;

std::optional<std::string> text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(stream), {});
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
  const std::string content = native_content(source);
  const fs::path library = native_library_file(*folder, content);
  if (text_of(fs::path(library).replace_extension(".c")) != content) return std::nullopt;
  return open_library(library);
}

Expected<NativeLibrary> compile_native(const std::string& source) {
  auto job = NativeJob::start(source);
  if (!job) return tl::unexpected(job.error());
  return (*job)->finish();
}

}  // namespace saltus::evaluation
