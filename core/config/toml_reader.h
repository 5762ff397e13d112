/// The one TOML reader: study text or file -> Study, and Study -> commented text.
#pragma once

#include <string>
#include <vector>

#include "core/config/study.h"

namespace drumsweep {

/// Reads and validates a study.
/// @throws InputError: missing file; TOML error with line and column; unknown key with "did you mean"; wrong type or
/// range.
/// @param changes  of the command line, made one after the other, see changed_study()
Study read_study(const std::string& path, const std::vector<std::string>& changes = {});

/// The same from text; `source` names it in messages. Keys that the text leaves out are those of `base`.
Study parse_study(const std::string& text, const std::string& source, const Study& base = {});

/// The study with one key changed, from a command line: "belt.speed_m_s=0.1". The value is TOML, a bare word a text.
/// @param source  names the option in messages. @throws InputError as parse_study()
Study changed_study(const Study& study, const std::string& change, const std::string& source);

/// The study as TOML with every key written out, each with its help and accepted range as a comment when `comments`.
/// parse_study(write_study(s)) gives back s exactly.
std::string write_study(const Study& study, bool comments);

}  // namespace drumsweep
