// Readers of the tables of a model file, one each.
#pragma once

#include <optional>

#include "saltus/io/toml/toml_model.hpp"
#include "saltus/io/toml/toml_reader_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::io {

void read_model_table(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_outputs(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_parameters(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_states(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_controls(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_events(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_modes(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_jumps(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_mechanics(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_contacts(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_hysteresis(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_simulate(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_optimize(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_time_freezing(TomlReader& reader, const TomlEntry& entry, ModelFile& model);

void read_tables(TomlReader& reader, const TomlEntry& entry, ModelFile& model);

/// Returns what stands for a value in expressions: states, parameters, definitions and the like.
[[nodiscard]] std::vector<std::string> value_names(const TomlTable& document);
/// Returns names of the tables [tables.NAME]: expressions anywhere in the file may call them.
[[nodiscard]] std::vector<std::string> table_names(const TomlTable& document);
/// Returns a file named in a model file, relative to it.
[[nodiscard]] std::filesystem::path beside(const std::string& model, const std::string& file);
/// Reads samples of a control from a file of numbers (source "file") or a stored result ("result").
[[nodiscard]] Expected<model::SampledInput> sampled_input(const std::string& control, std::string_view source,
                                                          const std::filesystem::path& file,
                                                          const SourceLocation& location,
                                                          std::vector<result::NamedFile>& files);

/// Reads samples of a control that stand in the model file: { times = [0, 1], values = [2, 3] }.
void read_listed_samples(TomlReader& reader, const TomlEntry& field, const TomlTable& source, ModelFile& model);

/// Reads the value of an option: truth, number, word or list of numbers; nullopt and an error for anything else.
[[nodiscard]] std::optional<result::OptionValue> read_option_value(TomlReader& reader, const TomlValue& value);

/// Reads a table of name = expression, which is called what is expected.
void read_expressions(TomlReader& reader, const TomlValue& value, std::string_view expected,
                      std::vector<model::NamedExpression>& expressions);

/// Returns the inclusion a word names, or an error without location.
[[nodiscard]] Expected<model::Inclusion> inclusion_named(const std::string& word);

}  // namespace saltus::io
