#include "formats/sdf/comms.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/text.h"

namespace sandlot::formats {
namespace {

constexpr const char* radio_kind = "radio";  ///< of medium and device

/// "rfcomms" of name="gz::sim::systems::RFComms", or of filename="libgz-sim-rf-comms-system.so" where it has no name.
std::string plain_name(const Xml& plugin) {
  const std::string* name = plugin.attribute("name");
  if (!name || name->empty()) name = plugin.attribute("filename");
  if (!name) return "";
  std::string out;
  for (const char c : name->substr(name->rfind(':') + 1))
    if (c != '_' && c != '-') out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* const known : {"rfcomms", "perfectcomms"})
    if (out.find(known) != std::string::npos) return known;
  return "";
}

model::ElementDecl medium(const char* name, const Xml& plugin,
                          std::initializer_list<std::pair<const char*, std::string>> keys) {
  model::ElementDecl out{name, radio_kind, Node::map(plugin.place), plugin.place};
  for (const auto& [key, value] : keys) out.config.set(key, Node::scalar(value, plugin.place));
  return out;
}

Status read_rf(const Xml& plugin, const Reading& in, WorldContent& out) {
  double max_range_m = 50, exponent = 2.5, l0_dB = 40, sigma = 10;
  double capacity_bitps = 54e6, power_dBm = 27, noise_floor_dBm = -90;
  in.notes.unused(plugin, "range_config radio_config");
  if (const Xml* const range = plugin.child("range_config")) {
    in.notes.unused(*range, "max_range fading_exponent l0 sigma");
    SL_TRY(read_child(*range, "max_range", {-1e6, 1e6}, max_range_m));
    SL_TRY(read_child(*range, "fading_exponent", {0.5, 10}, exponent));
    SL_TRY(read_child(*range, "l0", {-100, 300}, l0_dB));
    SL_TRY(read_child(*range, "sigma", {0, 900}, sigma));
  }
  if (const Xml* const radio = plugin.child("radio_config")) {
    in.notes.unused(*radio, "capacity tx_power noise_floor modulation");
    SL_TRY(read_child(*radio, "capacity", {1, 1e12}, capacity_bitps));
    SL_TRY(read_child(*radio, "tx_power", {-200, 100}, power_dBm));
    SL_TRY(read_child(*radio, "noise_floor", {-290, 100}, noise_floor_dBm));
    if (const Xml* const modulation = radio->child("modulation"); modulation && modulation->text != "QPSK")
      in.notes.warn(*modulation, "modulation '" + modulation->text.substr(0, 40) + "' is taken as QPSK",
                    "Gazebo does so, too");
  }
  // Gazebo's radios have no sensitivity: a weak packet has wrong bits.
  model::ElementDecl decl = medium("rf_comms", plugin,
                                   {{"model", "log_distance"},
                                    {"exponent", number_text(exponent)},
                                    {"reference_loss", number_text(l0_dB)},
                                    {"fading", number_text(std::sqrt(sigma))},
                                    {"bandwidth", number_text(capacity_bitps)},
                                    {"header", "0"},
                                    {"noise_floor", number_text(noise_floor_dBm)},
                                    {"sensitivity", number_text(noise_floor_dBm - 10)},
                                    {"modulation", "qpsk"},
                                    {"collisions", "false"},
                                    {"half_duplex", "false"},
                                    {"jitter", "0"}});
  if (max_range_m > 0) decl.config.set("range", Node::scalar(number_text(max_range_m), plugin.place));
  out.media.push_back(std::move(decl));
  out.endpoint_power_dBm = power_dBm;
  return {};
}

bool is_endpoint(const model::DeviceDecl& device) {
  return std::find(device.sdf_types.begin(), device.sdf_types.end(), "plugin:CommsEndpoint") !=
         device.sdf_types.end();
}

/// Warns of what an endpoint has in addition to its address.
void warn_of_the_rest(const model::DeviceDecl& endpoint, const Reading& in) {
  if (!endpoint.config.is_map()) return;
  for (const Node::Entry& entry : endpoint.config.entries())
    if (entry.key != "address" && !starts_with(entry.key, "@") && entry.key != "#text")
      in.notes.warn(
          Xml{.name = entry.key, .place = entry.key_place},
          "<" + entry.key.substr(0, 60) + "> of the plugin CommsEndpoint is not supported and has no effect");
}

}  // namespace

Result<bool> read_comms(const Xml& plugin, const Reading& in, WorldContent& out) {
  const std::string name = plain_name(plugin);
  if (name.empty()) return false;
  if (name == "rfcomms") {
    SL_TRY(read_rf(plugin, in, out));
  } else {
    in.notes.unused(plugin, "");
    out.media.push_back(medium("perfect_comms", plugin,
                               {{"range", "1000000"},
                                {"bandwidth", "1e12"},
                                {"header", "0"},
                                {"collisions", "false"},
                                {"half_duplex", "false"},
                                {"jitter", "0"}}));
  }
  return true;
}

void connect_endpoints(WorldContent& content, const Reading& in) {
  if (content.media.empty()) return;
  for (model::Instance& instance : content.instances) {
    if (std::none_of(std::as_const(instance.devices).begin(), std::as_const(instance.devices).end(),
                     is_endpoint))
      continue;
    for (model::DeviceDecl& device : instance.devices.edit()) {
      if (!is_endpoint(device)) continue;
      warn_of_the_rest(device, in);
      Node config = Node::map(device.place);
      if (const Node* const address = device.config.find("address")) config.set("address", *address);
      config.set("medium", Node::scalar(content.media.front().name, device.place));
      config.set("power", Node::scalar(number_text(content.endpoint_power_dBm), device.place));
      device.config = std::move(config);
      device.kind = radio_kind;
      device.sdf_types.clear();
    }
  }
}

}  // namespace sandlot::formats
