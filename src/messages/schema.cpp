#include "messages/schema.h"

#include <algorithm>

namespace sandlot {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

void add_body(const MessageInfo& info, std::string& text) {
  for (const MessageConstant& constant : info.constants)
    text += std::string(name_of(constant.type)) + " " + constant.name + "=" +
            (constant.type == Wire::string ? quoted(constant.value) : constant.value) + "\n";
  for (const MessageField& field : info.fields) {
    text += field.type == Wire::message ? short_name(field.message->name) : name_of(field.type);
    if (field.count == MessageField::Count::array) text += "[" + std::to_string(field.length) + "]";
    if (field.count == MessageField::Count::sequence)
      text += field.length ? "[<=" + std::to_string(field.length) + "]" : "[]";
    text += " " + field.name + "\n";
  }
}

void add_types(const MessageInfo& info, std::vector<const MessageInfo*>& types) {
  for (const MessageField& field : info.fields)
    if (field.type == Wire::message && std::find(types.begin(), types.end(), field.message) == types.end()) {
      types.push_back(field.message);
      add_types(*field.message, types);
    }
}

}  // namespace

std::string schema_text(const MessageInfo& info) {
  std::string text;
  add_body(info, text);
  std::vector<const MessageInfo*> types;
  add_types(info, types);
  for (const MessageInfo* type : types) {
    text += std::string(80, '=') + "\nMSG: " + short_name(type->name) + "\n";
    add_body(*type, text);
  }
  return text;
}

}  // namespace sandlot
