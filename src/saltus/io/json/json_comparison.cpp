// The record of `compare`.
#include "saltus/io/json/json_record_members_internal.hpp"

namespace saltus::io {
namespace {

/// A row that was not run has its reason and nothing else.
Json run_json(const result::ComparedRun& run) {
  if (run.reason.empty()) return record_json(run);
  return {{"method", run.method}, {"variant", run.variant}, {"reason", run.reason}};
}

result::ComparedRun read_run(JsonReader& reader, const Json& json, const std::string& path) {
  result::ComparedRun run;
  reader.read_if_there(json, path, "reason", run.reason);
  if (run.reason.empty()) {
    read_record(reader, json, path, run);
  } else {
    reader.read_member(json, path, "method", run.method);
    reader.read_member(json, path, "variant", run.variant);
  }
  return run;
}

}  // namespace

Json comparison_json(const result::Comparison& comparison) {
  Json runs = Json::array();
  for (const auto& run : comparison.runs) runs.push_back(run_json(run));
  return {{"reference", comparison.reference}, {"time", value_json(comparison.time)}, {"runs", std::move(runs)}};
}

void read_comparison(JsonReader& reader, const Json& json, const std::string& path,
                     std::optional<result::Comparison>& comparison) {
  comparison.emplace();
  std::int64_t reference = 0;
  reader.read_member(json, path, "reference", reference);
  reader.read_if_there(json, path, "time", comparison->time);
  if (const auto* runs = reader.member(json, path, "runs")) {
    read_list(reader, *runs, path + "/runs", comparison->runs, read_run);
  }
  const auto count = static_cast<std::int64_t>(comparison->runs.size());
  if (reference < 0 || reference >= count) {
    reader.fail(path + "/reference", fmt::format("expected a number of `runs`, found {} of {}", reference, count));
  } else {
    comparison->reference = static_cast<std::size_t>(reference);
  }
}

}  // namespace saltus::io
