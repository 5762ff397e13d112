/// Just enough JSON to print one object: keys stay in order, a number that is not finite becomes null.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace drumsweep {

std::string json_text(const std::string& text);
/// All digits needed to read the same double back.
std::string json_number(double value);

class JsonObject {
 public:
  JsonObject& raw(const std::string& key, const std::string& json);  ///< a value that is JSON already
  JsonObject& text(const std::string& key, const std::string& value) { return raw(key, json_text(value)); }
  JsonObject& number(const std::string& key, double value) { return raw(key, json_number(value)); }
  JsonObject& count(const std::string& key, std::int64_t value) { return raw(key, std::to_string(value)); }
  JsonObject& flag(const std::string& key, bool value) { return raw(key, value ? "true" : "false"); }
  std::string str() const { return "{" + body_ + "}"; }

 private:
  std::string body_;
};

std::string json_list(const std::vector<std::string>& items);

}  // namespace drumsweep
