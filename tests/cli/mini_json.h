/// A strict little JSON reader: enough to see that an output is one valid object, and to look values up.
#pragma once

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace drumsweep {

struct Json {
  enum class Type { null, boolean, number, text, list, object } type = Type::null;
  double number = 0;  ///< of a boolean: 0 or 1
  std::string text;
  std::vector<Json> list;
  std::map<std::string, Json> object;

  bool has(const std::string& key) const { return object.count(key) != 0; }
  const Json& operator[](const std::string& key) const {
    const auto found = object.find(key);
    if (found == object.end()) throw std::runtime_error("no key " + key);
    return found->second;
  }
};

class JsonReader {
 public:
  /// @throws std::runtime_error when the text is anything but one JSON value and white space
  static Json parse(const std::string& text) {
    JsonReader reader{text};
    const Json value = reader.value();
    reader.blank();
    if (reader.at_ != text.size()) throw std::runtime_error("text after the value: " + text.substr(reader.at_));
    return value;
  }

 private:
  explicit JsonReader(const std::string& text) : text_(text) {}
  void blank() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  bool take(const std::string& word) {
    blank();
    if (text_.compare(at_, word.size(), word) != 0) return false;
    at_ += word.size();
    return true;
  }
  void need(const std::string& word) {
    if (!take(word)) throw std::runtime_error("expected " + word + " at: " + text_.substr(at_, 30));
  }
  std::string string() {
    need("\"");
    std::string out;
    while (at_ < text_.size() && text_[at_] != '"') {
      if (static_cast<unsigned char>(text_[at_]) < 0x20) throw std::runtime_error("control character in a text");
      if (text_[at_] == '\\') ++at_;
      out += text_.at(at_++);
    }
    need("\"");
    return out;
  }
  Json value() {
    Json v;
    if (take("{")) {
      v.type = Json::Type::object;
      if (take("}")) return v;
      do {
        blank();
        const std::string key = string();
        need(":");
        if (!v.object.emplace(key, value()).second) throw std::runtime_error("key twice: " + key);
      } while (take(","));
      need("}");
    } else if (take("[")) {
      v.type = Json::Type::list;
      if (take("]")) return v;
      do v.list.push_back(value());
      while (take(","));
      need("]");
    } else if (take("null")) {
      v.type = Json::Type::null;
    } else if (take("true") || take("false")) {
      v.type = Json::Type::boolean;
      v.number = text_[at_ - 2] == 'u' ? 1 : 0;
    } else if (blank(); at_ < text_.size() && text_[at_] == '"') {
      v.type = Json::Type::text;
      v.text = string();
    } else {
      // strtod would take nan and inf, which JSON has not.
      v.type = Json::Type::number;
      const std::size_t end = text_.find_first_not_of("+-0123456789.eE", at_);
      const std::string digits = text_.substr(at_, end - at_);
      char* rest = nullptr;
      v.number = std::strtod(digits.c_str(), &rest);
      if (digits.empty() || *rest != '\0') throw std::runtime_error("no value at: " + text_.substr(at_, 30));
      at_ += digits.size();
    }
    return v;
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

}  // namespace drumsweep
