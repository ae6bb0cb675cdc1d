#include "saltus/cli/growing_outputs.hpp"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "saltus/cli/text/terminal.hpp"

namespace saltus::cli {

void SizeNote::grows(const std::string& file) {
  said_ = true;
  print_error(fmt::format("note: {} grows beyond {} MB{}", file, large / 1000000,
                          file.ends_with(".npz") ? ""
                                                 : "; --out NAME.npz holds the same numbers in a fraction of it, --set "
                                                   "simulate.output.points=1000 has fewer rows, "
                                                   "simulate.output.states=x1 fewer columns; events stay whole"));
}

void SizeNote::end(const std::string& file, std::size_t bytes) const {
  if (bytes >= large) print_error(fmt::format("note: {} has {:.0f} MB", file, static_cast<double>(bytes) / 1e6));
}

bool GrowingOutputs::pass(File& file, std::string_view piece) {
  file.bytes += piece.size();
  if (watch_ && !watch_(file.name, file.bytes)) return false;
  if (file.file) return file.file->write(piece);
  print(piece);
  return true;
}

void GrowingOutputs::begin() {
  begun_ = true;
  for (const auto& name : names_) {
    auto& file = *files_.emplace_back(std::make_unique<File>());
    file.name = name;
    file.sink = [this, &file](std::string_view piece) { return pass(file, piece); };
    const bool standard = name == "-";
    const std::string kind = standard ? format_ : name;
    if (!standard) file.file = std::make_unique<io::GrowingFile>(name);
    const auto folder = standard ? std::filesystem::temp_directory_path() : io::target_of(name).parent_path();
    file.parts = kind.ends_with("events.csv") ? io::events_csv_parts(file.sink)
                 : kind.ends_with("csv")      ? io::csv_parts(file.sink)
                 : kind.ends_with("npz")      ? io::npz_parts(folder.empty() ? "." : folder, file.sink)
                                              : io::json_parts(folder.empty() ? "." : folder, file.sink);
  }
}

/// What became of what was just written of a file.
void GrowingOutputs::note(File& file, const Expected<void>& outcome) {
  file.good = outcome.has_value();
  if (!outcome && file.file) file.file->spoil(outcome.error().message);
}

bool GrowingOutputs::add(const result::Result& part) {
  if (!begun_) begin();
  bool good = true;
  for (auto& file : files_) {
    if (file->good) note(*file, file->parts->add(part));
    good = good && file->good;
  }
  const auto& events = part.events;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const bool shown = first_.size() < most_ || events.size() - i <= most_;
    if (!shown) continue;
    auto& list = first_.size() < most_ ? first_ : last_;
    list.push_back(events[i]);
    if (last_.size() > most_) last_.erase(last_.begin());
  }
  return good;
}

result::Events GrowingOutputs::ends() const {
  result::Events events = first_;
  for (const auto& event : last_) events.push_back(event);
  return events;
}

Expected<void> GrowingOutputs::finish(const result::Result& rest,
                                      const std::function<bool(const std::string&, std::size_t)>& watch) {
  Expected<void> outcome;
  watch_ = watch;
  for (auto& file : files_) {
    if (file->good) note(*file, file->parts->finish(rest));
    const bool is_ended = watch_ && !watch_(file->name, file->bytes);
    if (is_ended && file->file) file->file->remove();
    if (is_ended) break;
    if (!file->file) continue;
    auto done = file->file->complete();
    if (!done && outcome) outcome = std::move(done);
  }
  return outcome;
}

}  // namespace saltus::cli
