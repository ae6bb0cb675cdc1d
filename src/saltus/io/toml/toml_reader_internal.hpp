// Reads checked values out of a TOML document. Keeps the errors, so that the readers of tables stay straight lines.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/expression/syntax_tree.hpp"
#include "saltus/io/toml/toml_document_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::io {

class TomlReader {
 public:
  /// @param files  those that the document names; must outlive this
  TomlReader(std::string file, std::vector<result::NamedFile>& files) : file_(std::move(file)), files_(&files) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::vector<result::NamedFile>& files() { return *files_; }
  [[nodiscard]] const std::vector<Error>& errors() const { return errors_; }
  /// Returns whether something of the entry that was begun last is wrong, or of the table without entries.
  [[nodiscard]] bool failed() const { return errors_.size() > errors_before_; }

  /// Sets the names of tables of the model, which expressions may call; set before the first expression is read.
  /// @param declared  names of values, which expressions may have
  void set_functions(std::vector<std::string> names, std::vector<std::string> declared = {}) {
    functions_ = std::move(names);
    declared_ = std::move(declared);
  }

  /// Sets the table that errors are in, as a context frame; empty for none.
  void enter(std::string table) {
    table_ = std::move(table);
    begin_entry();
  }

  /// Sets that what follows is an entry of its own, like one of [[jumps]].
  void begin_entry() {
    errors_before_ = errors_.size();
    has_unknown_key_ = false;
  }
  /// Returns whether all keys of the entry are known; of another one it is not known what it states.
  [[nodiscard]] bool is_understood() const { return !has_unknown_key_; }

  /// Keeps the error, with the table it is in; of several at one place the first.
  void fail(Error error);
  void wrong_type(std::string_view expected, const TomlValue& found, std::string remedy = "");
  /// Notes what a table does not have; nothing beside an unknown key, which may be meant by it.
  void missing(std::string message, std::string remedy, const SourceLocation& location);
  /// Notes an unknown key, with the nearest of `known`.
  void unknown_key(const TomlEntry& entry, const std::vector<std::string>& known);
  void not_available(const SourceLocation& location, std::string_view what);

  /// Reads the value as a table, or null and an error.
  /// @param expected  "the table [name]", or what stands in braces
  const TomlTable* table(const TomlValue& value, std::string_view expected);
  /// Reads the value as tables that begin with [[name]], none and an error where it is not.
  const TomlArray& tables(const TomlValue& value, std::string_view name);
  /// Reads a number or an expression in quotes; after an error expression::unreadable.
  expression::NodePtr expression(const TomlValue& value);
  /// Reads a part of a string as an expression, for texts that are no expression as a whole; as above.
  expression::NodePtr expression_in(const TomlString& text, std::size_t offset, std::size_t length);
  /// Reads as `expression`, but plus or minus infinity means no bound: null.
  expression::NodePtr bound(const TomlValue& value);
  /// Reads a number, not an expression; nothing after an error.
  std::optional<double> number(const TomlValue& value);
  std::string string(const TomlValue& value, std::string_view expected);
  bool boolean(const TomlValue& value);

 private:
  std::string file_;
  std::vector<result::NamedFile>* files_;
  std::string table_;
  std::vector<std::string> functions_, declared_;
  std::vector<Error> errors_;
  std::size_t errors_before_ = 0;  ///< when the entry was begun
  bool has_unknown_key_ = false;   ///< in the entry that was begun last
};

/// Returns where a byte of a string stands in the file.
[[nodiscard]] SourceLocation place_in_string(const TomlString& text, std::size_t offset);

}  // namespace saltus::io
