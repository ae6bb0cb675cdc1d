// Readers of the tables of a model file, one each.
#pragma once

#include "saltus/io/toml_model.hpp"
#include "saltus/io/toml_reader_internal.hpp"

namespace saltus::io {

void read_model_table(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_parameters(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_states(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_controls(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_events(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_modes(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_jumps(TomlReader& reader, const TomlEntry& entry, ModelFile& model);
void read_simulate(TomlReader& reader, const TomlEntry& entry, ModelFile& model);

/// A table of name = expression.
void read_expressions(TomlReader& reader, const TomlEntry& entry, std::vector<model::NamedExpression>& expressions);

/// The inclusion a word names, or an error without location.
[[nodiscard]] Expected<model::Inclusion> inclusion_named(const std::string& word);

}  // namespace saltus::io
