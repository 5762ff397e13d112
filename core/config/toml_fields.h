/// What reading a study and reading a scene share: TOML tables into a list of fields.
#pragma once

#include <toml++/toml.h>

#include <map>
#include <string>
#include <vector>

#include "core/config/schema.h"

namespace drumsweep {

/// "source:line:column: "
std::string place(const std::string& source, const toml::source_region& region);

/// Integers are accepted where a real number is expected. @throws InputError
double real_number(const toml::node& node, const std::string& here, const std::string& key);

/// @throws InputError with line and column
toml::table parse_toml(const std::string& text, const std::string& source);

/// A text in quotes, escaped; a number with all digits needed to read it back exactly, and never like an integer.
std::string toml_text(const std::string& text);
std::string toml_number(double value);

/// "KEY=VALUE" of a command line, each a line of TOML; what is no value of TOML is a text.
/// @param source  names the option in messages. @throws InputError
toml::table changes_as_toml(const std::vector<std::string>& changes, const std::string& source);

/// Whole file. @throws InputError
std::string read_text(const std::string& path);

/// Fills fields from a table and remembers where each stood.
struct FieldReader {
  const std::string& source;
  std::vector<Field> known;
  std::string list_name;                      ///< a top-level key that is read elsewhere ("stage"); may be empty
  std::map<std::string, std::string> places;  ///< key -> "file:line:column: "

  /// Walks a table; `prefix` is "" or "drum.texture.". @throws InputError: unknown key with "did you mean", wrong type
  void table(const toml::table& node, const std::string& prefix);
  Where where() const;

 private:
  [[noreturn]] void unknown(const std::string& here, const std::string& key) const;
};

/// Fields as TOML tables in their order; help and ranges as comments when `comments`.
std::string write_fields(const std::vector<Field>& list, bool comments);

}  // namespace drumsweep
