/// Collects the keys of one table of a study or scene file; see schema.h.
#pragma once

#include "core/config/schema.h"

namespace drumsweep {

struct FieldTable {
  std::vector<Field>& list;
  std::string name;  ///< "drum.", with the dot
  Scope scope = Scope::label;

  static constexpr double unbounded = std::numeric_limits<double>::infinity();

  void number(const char* key, double& value, double low, double high, const char* help, bool optional = false) {
    list.push_back({name + key, &value, low, high, optional, {}, scope, help});
  }
  void count(const char* key, std::int64_t& value, double low, double high, const char* help) {
    list.push_back({name + key, &value, low, high, false, {}, scope, help});
  }
  void flag(const char* key, bool& value, const char* help) {
    list.push_back({name + key, &value, -unbounded, unbounded, false, {}, scope, help});
  }
  void text(const char* key, std::string& value, std::vector<std::string> choices, const char* help) {
    list.push_back({name + key, &value, -unbounded, unbounded, false, std::move(choices), scope, help});
  }
};

}  // namespace drumsweep
