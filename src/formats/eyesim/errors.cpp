#include "formats/eyesim/errors.h"

#include <algorithm>

#include "base/text.h"

namespace sandlot::formats::eyesim {
namespace {

/// {name: {key: value, ...}}
Node stage(const Place& place, const char* name, std::initializer_list<std::pair<const char*, double>> keys) {
  Node inner = Node::map(place), out = Node::map(place);
  for (const auto& [key, value] : keys) inner.set(key, Node::scalar(number_text(value), place));
  out.set(name, std::move(inner));
  return out;
}
Node one_stage(const Place& place, double std) {
  Node list = Node::sequence(place);
  list.push(stage(place, "gaussian", {{"std", std}}));
  return list;
}

Result<double> deviation(const Line& line, std::size_t word) {
  SL_ASSIGN(const double std, number_at(line, word, "a standard deviation"));
  return std >= 0 ? Result<double>(std) : line.error("a standard deviation is not below 0");
}
Result<double> probability(const Line& line, std::size_t word) {
  SL_ASSIGN(const double p, number_at(line, word, "a probability"));
  return p >= 0 && p <= 1 ? Result<double>(p) : line.error("a probability is from 0 to 1");
}

}  // namespace

Status ErrorModels::take(const Line& line) {
  place = line.place;
  const std::string what = line.arguments() < 1 ? "" : lower(line.words[1]);
  if (what == "psd") {
    SL_ASSIGN(const double std, deviation(line, 2));
    psd_std_m = std * mm;
    return {};
  }
  if (what == "v") {
    SL_ASSIGN(const double std, deviation(line, 2));
    v_std_mps = std * mm;
    return {};
  }
  if (what == "omega") {
    SL_ASSIGN(const double std, deviation(line, 2));
    omega_std_radps = radians(std);
    return {};
  }
  if (what == "radio") {
    SL_ASSIGN(const double bits, probability(line, 2));
    SL_ASSIGN(const double packets, probability(line, 3));
    if (bits > 0.5) return line.error("more than half of the bits are wrong", "P_b is at most 0.5");
    bit_error_rate = bits;
    drop = packets;
    return {};
  }
  if (what == "camera") {
    const std::string kind = line.arguments() < 2 ? "" : lower(line.words[2]);
    if (camera.is_null()) camera = Node::sequence(line.place);
    if (kind == "gaussian") {
      SL_ASSIGN(const double std, deviation(line, 3));
      if (std > 2550) return line.error("a picture has grey levels from 0 to 255");
      camera.push(stage(line.place, "gaussian", {{"std", std / 255}}));
      return {};
    }
    if (kind == "salt_and_pepper") {
      SL_ASSIGN(const double p, probability(line, 3));
      camera.push(stage(line.place, "salt_and_pepper", {{"salt", p / 2}, {"pepper", p / 2}}));
      return {};
    }
    if (kind == "hundreds_and_thousands") {
      SL_ASSIGN(const double p, probability(line, 3));
      camera.push(stage(line.place, "hundreds_and_thousands", {{"rate", p}}));
      return {};
    }
    return line.error("'" + kind.substr(0, 40) + "' is not an error of cameras",
                      "known are gaussian, salt_and_pepper and hundreds_and_thousands");
  }
  return line.error("'" + what.substr(0, 40) + "' has no error model",
                    "known are psd, v, omega, camera and radio");
}

Node ErrorModels::keys_for(const std::string& kind) const {
  Node out = Node::map(place);
  if (kind == "range_finder" && psd_std_m > 0) out.set("noise", one_stage(place, psd_std_m));
  if (kind == "camera" && !camera.is_null()) out.set("noise", camera);
  if (kind.size() > 6 && kind.substr(kind.size() - 6) == "_drive" && (v_std_mps > 0 || omega_std_radps > 0)) {
    Node errors = Node::map(place);
    if (v_std_mps > 0) errors.set("linear", one_stage(place, v_std_mps));
    if (omega_std_radps > 0) errors.set("angular", one_stage(place, omega_std_radps));
    out.set("command_errors", std::move(errors));
  }
  return out.entries().empty() ? Node() : out;
}

Node ErrorModels::keys_to_tune(const std::string& kind, const Place& at) const {
  const Place& here = place.file ? place : at;
  Node out = Node::map(here);
  if (kind == "range_finder") {
    out.set("noise", one_stage(here, psd_std_m));
  } else if (kind == "camera") {
    Node stages = camera.is_null() ? Node::sequence(here) : camera;
    const auto has = [&](const char* name) {
      return std::any_of(stages.items().begin(), stages.items().end(),
                         [&](const Node& each) { return each.find(name) != nullptr; });
    };
    if (!has("gaussian")) stages.push(stage(here, "gaussian", {{"std", 0}}));
    if (!has("salt_and_pepper")) stages.push(stage(here, "salt_and_pepper", {{"salt", 0}, {"pepper", 0}}));
    if (!has("hundreds_and_thousands")) stages.push(stage(here, "hundreds_and_thousands", {{"rate", 0}}));
    out.set("noise", std::move(stages));
  } else if (kind.size() > 6 && kind.substr(kind.size() - 6) == "_drive") {
    Node errors = Node::map(here);
    errors.set("linear", one_stage(here, v_std_mps));
    errors.set("angular", one_stage(here, omega_std_radps));
    out.set("command_errors", std::move(errors));
  }
  return out.entries().empty() ? Node() : out;
}

}  // namespace sandlot::formats::eyesim
