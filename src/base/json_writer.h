#pragma once
/// JSON written as text in one pass, without a tree of values.
///
///   std::string out;
///   JsonWriter w(out);
///   w.object([&] {
///     w.key("name").text("ann");
///     w.key("position").numbers({1.5, 2});
///   });
///
/// Output   appended, without blanks. Numbers have the shortest form that reads back as the same; NaN and infinities are null;
///          bytes that are not UTF-8 become U+FFFD.
/// Errors   none: a key without a value, or outside an object, is written as it was called.
/// Reading  is nlohmann/json's work, in the few sources that parse foreign JSON: its header costs a source 1 to 3 s of compile
///          time.
#include <charconv>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace sandlot {

/// Appends a text as a JSON string.
void append_json(std::string_view text, std::string& out);
void append_json(double number, std::string& out);
void append_json(float number, std::string& out);

class JsonWriter {
 public:
  explicit JsonWriter(std::string& out) : out_(out) {}

  JsonWriter& key(std::string_view name) {
    separate();
    append_json(name, out_);
    out_ += ':';
    first_ = true;
    return *this;
  }
  void text(std::string_view value) { separate(), append_json(value, out_); }
  void number(double value) { separate(), append_json(value, out_); }
  void number(float value) { separate(), append_json(value, out_); }
  /// A number that readers with two kinds of numbers shall take for a floating-point one: 2 is 2.0.
  void real(double value);
  void integer(std::integral auto value) {
    separate();
    char text[24];
    out_.append(text, std::to_chars(text, text + sizeof text, value).ptr);
  }
  void flag(bool value) { separate(), out_ += value ? "true" : "false"; }
  void null() { separate(), out_ += "null"; }
  /// A value that is JSON already.
  void raw(std::string_view json) { separate(), out_ += json; }

  void begin_object() { open('{'); }
  void end_object() { close('}'); }
  void begin_list() { open('['); }
  void end_list() { close(']'); }
  template <class F>
  void object(F&& members) {
    begin_object();
    members();
    end_object();
  }
  template <class F>
  void list(F&& elements) {
    begin_list();
    elements();
    end_list();
  }
  void numbers(std::initializer_list<double> values) {
    list([&] {
      for (const double value : values) number(value);
    });
  }
  void texts(const auto& values) {
    list([&] {
      for (const auto& value : values) text(value);
    });
  }

 private:
  /// A comma, unless the value is the first of its list or follows its key.
  void separate() {
    if (!first_) out_ += ',';
    first_ = false;
  }
  void open(char bracket) {
    separate();
    out_ += bracket;
    first_ = true;
  }
  void close(char bracket) {
    out_ += bracket;
    first_ = false;
  }
  std::string& out_;
  bool first_ = true;
};

}  // namespace sandlot
