// Files of --out that are written while a run goes on.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/result/result.hpp"

namespace saltus::cli {

/// Says once of a file that it becomes large, as soon as it does; at the end, how large.
class SizeNote {
 public:
  /// Returns whether it is time to say so.
  [[nodiscard]] bool is_due(std::size_t bytes) const { return !said_ && bytes >= large; }
  void grows(const std::string& file);
  void end(const std::string& file, std::size_t bytes) const;

 private:
  static constexpr std::size_t large = 50000000;
  bool said_ = false;
};

/// Gets the parts of a run (pipeline::Observers::on_part). Begins with the first one.
class GrowingOutputs {
 public:
  /// @param names   files, or - for standard output in this format
  /// @param events  so many at each end are kept for the table
  GrowingOutputs(std::vector<std::string> names, std::string format, std::size_t events)
      : names_(std::move(names)), format_(std::move(format)), most_(events) {}

  [[nodiscard]] bool begun() const { return begun_; }
  /// Tells whether nothing is written: rows are wanted by nobody.
  [[nodiscard]] bool only_counts() const { return names_.empty(); }
  /// Returns false if something could not be written: a run need not go on.
  bool add(const result::Result& part);
  /// Calls say(note, file) for those that have become large.
  template <class Say>
  void for_each_due_note(Say say) {
    for (auto& file : files_) {
      if (file->note.is_due(std::max(file->bytes, file->parts->bytes_aside()))) say(file->note, file->name);
    }
  }
  /// Returns the first and the last events.
  [[nodiscard]] result::Events ends() const;
  /// Writes the rest and puts the files in their places; returns the first failure.
  /// @param watch  called before each piece with the name of the file; false ends the writing, and removes the file
  [[nodiscard]] Expected<void> finish(const result::Result& rest,
                                      const std::function<bool(const std::string& name, std::size_t bytes)>& watch);

  void note_large_files() const {
    for (const auto& file : files_) file->note.end(file->name, file->bytes);
  }

 private:
  struct File {
    std::string name;
    std::unique_ptr<io::GrowingFile> file;  ///< null: standard output
    std::function<bool(std::string_view)> sink;
    std::unique_ptr<io::ResultParts> parts;
    bool good = true;
    std::size_t bytes = 0;
    SizeNote note;
  };
  void begin();
  bool pass(File& file, std::string_view piece);
  static void note(File& file, const Expected<void>& outcome);

  std::vector<std::string> names_;
  std::string format_;
  std::size_t most_;
  bool begun_ = false;
  std::vector<std::unique_ptr<File>> files_;
  std::vector<result::Event> first_, last_;
  std::function<bool(const std::string& name, std::size_t bytes)> watch_;
};

}  // namespace saltus::cli
