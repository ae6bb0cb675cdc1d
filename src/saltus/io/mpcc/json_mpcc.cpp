#include "saltus/io/mpcc/json_mpcc.hpp"

#include <cmath>

#include "saltus/io/atomic_file.hpp"
#include "saltus/io/json/json_layout_internal.hpp"
#include "saltus/io/json/json_record_members_internal.hpp"

namespace saltus::io {
namespace {

constexpr const char* mpcc_format = "saltus-mpcc/1";

}  // namespace

std::string to_json(const result::MpccResult& result) {
  const auto& status = result.status;
  Json json{{"format", mpcc_format},
            {"file", result.file},
            {"sha256", result.sha256},
            {"status", {{"termination", name(status.termination)}, {"message", status.message}}},
            {"objective", result.objective},
            {"x", result.x},
            {"names", result.names},
            {"presolve", record_json(result.presolve)},
            {"certificate", record_json(result.certificate)},
            {"multipliers", record_json(result.multipliers)},
            {"homotopy", value_json(result.homotopy)},
            {"statistics", record_json(result.statistics)}};
  if (!result.starts.empty()) json["starts"] = value_json(result.starts);
  return laid_out(json);
}

Expected<std::vector<double>> read_mpcc_start(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  JsonReader reader(file.string());
  std::vector<double> x;
  try {
    const auto json = Json::parse(*text);
    std::string format;
    reader.read_member(json, "", "format", format);
    if (format != mpcc_format) {
      reader.fail("/format",
                  fmt::format("expected \"{}\", found \"{}\": no result of saltus mpcc", mpcc_format, format));
    }
    reader.read_member(json, "", "x", x);
  } catch (const Json::exception&) {
    reader.fail("/", "not valid JSON; expected a result written by saltus mpcc --out FILE.json");
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i])) reader.fail(fmt::format("/x/{}", i), "expected a finite number");
  }
  if (reader.error()) return tl::unexpected(*reader.error());
  return x;
}

}  // namespace saltus::io
