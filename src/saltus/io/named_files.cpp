#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "saltus/io/atomic_file.hpp"
#include "saltus/io/named_files_internal.hpp"
#include "saltus/io/sha256.hpp"

namespace saltus::io {
namespace {

constexpr std::size_t largest_named_file = std::size_t{64} << 20;
constexpr std::size_t largest_kept = 1000000;

}  // namespace

Expected<std::string> read_named(std::vector<result::NamedFile>& files, const std::filesystem::path& file) {
  const auto name = file.string();
  const auto known = std::find_if(files.begin(), files.end(), [&](const auto& other) { return other.name == name; });
  // Text that is no UTF-8 does not survive a result file.
  if (known != files.end() && known->text && sha256(*known->text) == known->sha256) return *known->text;
  auto text = read_file(file, largest_named_file);
  if (!text) return text;
  auto fingerprint = sha256(*text);
  if (known == files.end()) {
    files.push_back({name, std::move(fingerprint), std::nullopt});
    if (text->size() <= largest_kept) files.back().text = *text;
  } else if (known->sha256 != fingerprint) {
    return tl::unexpected(Error{ErrorCode::io_failure,
                                "this file is not the one with which the result was computed",
                                fmt::format("its sha256 was {}", known->sha256),
                                {name, 0, 0},
                                {}});
  }
  return text;
}

}  // namespace saltus::io
