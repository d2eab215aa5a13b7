/// The Foxglove protocol against bytes and texts written by hand from its specification.
#include "wire/foxglove.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/random.h"

namespace sandlot::foxglove {
namespace {

using Json = nlohmann::json;

template <class T>
T read_as(std::string_view text) {
  const auto message = read_text(text);
  if (!message) return ADD_FAILURE() << text << ": " << message.error().text(), T();
  const T* const found = std::get_if<T>(&*message);
  if (!found) return ADD_FAILURE() << text << ": another kind", T();
  return *found;
}

std::vector<std::byte> bytes(std::initializer_list<int> values, std::string_view tail = {}) {
  std::vector<std::byte> out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  for (const char c : tail) out.push_back(static_cast<std::byte>(c));
  return out;
}
std::string text_of(std::span<const std::byte> span) {
  return {reinterpret_cast<const char*>(span.data()), span.size()};
}
std::string error_of(std::string_view text) {
  const auto message = read_text(text);
  return message ? "no error" : message.error().text();
}

TEST(Foxglove, ClientsSubscribeAndAdvertise) {
  const auto subscribe = read_as<Subscribe>(
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":4294967295},{"id":7,"channelId":5,"extra":1}]})");
  ASSERT_EQ(subscribe.subscriptions.size(), 2u);
  EXPECT_EQ(subscribe.subscriptions[0].id, 0u);
  EXPECT_EQ(subscribe.subscriptions[0].channel, 4294967295u);
  EXPECT_EQ(subscribe.subscriptions[1].id, 7u);
  EXPECT_EQ(subscribe.subscriptions[1].channel, 5u);
  EXPECT_EQ(read_as<Unsubscribe>(R"({"op":"unsubscribe","subscriptionIds":[3,1]})").ids,
            (std::vector<std::uint32_t>{3, 1}));
  // What Lichtblick sends: a schema that we have no use for, and none for cdr.
  const auto advertise = read_as<Advertise>(
      R"({"op":"advertise","channels":[{"id":2,"topic":"/cmd_vel","encoding":"json","schemaName":"geometry_msgs/Twist",
          "schema":"","schemaEncoding":"ros2msg"},{"id":3,"topic":"/x","encoding":"cdr"}]})");
  ASSERT_EQ(advertise.channels.size(), 2u);
  EXPECT_EQ(advertise.channels[0].id, 2u);
  EXPECT_EQ(advertise.channels[0].topic, "/cmd_vel");
  EXPECT_EQ(advertise.channels[0].encoding, "json");
  EXPECT_EQ(advertise.channels[0].schema_name, "geometry_msgs/Twist");
  EXPECT_EQ(advertise.channels[1].schema_name, "");
  EXPECT_EQ(read_as<Unadvertise>(R"({"op":"unadvertise","channelIds":[2]})").ids,
            std::vector<std::uint32_t>{2});
}

TEST(Foxglove, ClientsAskForParametersGraphAndAssets) {
  const auto get = read_as<GetParameters>(R"({"op":"getParameters","parameterNames":["a","b"],"id":"q"})");
  EXPECT_EQ(get.names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(get.id, "q");
  EXPECT_EQ(read_as<GetParameters>(R"({"op":"getParameters","parameterNames":[]})").id, "");
  const auto set = read_as<SetParameters>(
      R"({"op":"setParameters","id":"s","parameters":[{"name":"f","value":2,"type":"float64"},{"name":"b","value":true},
          {"name":"t","value":"word"},{"name":"l","value":[1,2.5],"type":"float64_array"},{"name":"w","value":["x","y"]},
          {"name":"bytes","value":"AAE=","type":"byte_array"},{"name":"gone"},{"name":"null","value":null},{"name":"e","value":[]}]})");
  ASSERT_EQ(set.parameters.size(), 9u);
  EXPECT_EQ(set.id, "s");
  const auto& p = set.parameters;
  EXPECT_EQ(p[0].name, "f");
  EXPECT_EQ(p[0].type, "float64");
  EXPECT_EQ(std::get<double>(p[0].value), 2.0);
  EXPECT_EQ(std::get<bool>(p[1].value), true);
  EXPECT_EQ(std::get<std::string>(p[2].value), "word");
  EXPECT_EQ(std::get<std::vector<double>>(p[3].value), (std::vector<double>{1, 2.5}));
  EXPECT_EQ(std::get<std::vector<std::string>>(p[4].value), (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(std::get<std::string>(p[5].value), "AAE=");
  EXPECT_TRUE(std::holds_alternative<std::monostate>(p[6].value));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(p[7].value));
  EXPECT_TRUE(std::get<std::vector<double>>(p[8].value).empty());
  EXPECT_TRUE(
      read_as<SubscribeParameters>(R"({"op":"subscribeParameterUpdates","parameterNames":["a"]})").subscribe);
  EXPECT_FALSE(read_as<SubscribeParameters>(R"({"op":"unsubscribeParameterUpdates","parameterNames":["a"]})")
                   .subscribe);
  EXPECT_TRUE(read_as<SubscribeGraph>(R"({"op":"subscribeConnectionGraph"})").subscribe);
  EXPECT_FALSE(read_as<SubscribeGraph>(R"({"op":"unsubscribeConnectionGraph"})").subscribe);
  const auto fetch = read_as<FetchAsset>(R"({"op":"fetchAsset","uri":"sandlot://mesh/a5","requestId":9})");
  EXPECT_EQ(fetch.uri, "sandlot://mesh/a5");
  EXPECT_EQ(fetch.request, 9u);
}

TEST(Foxglove, ClientsSendBytes) {
  const auto sent = bytes({1, 0x78, 0x56, 0x34, 0x12}, "payload");
  const auto data = read_binary(sent);
  ASSERT_TRUE(data);
  EXPECT_EQ(std::get<ClientData>(*data).channel, 0x12345678u);
  EXPECT_EQ(text_of(std::get<ClientData>(*data).bytes), "payload");
  const auto called = bytes({2, 5, 0, 0, 0, 9, 1, 0, 0, 4, 0, 0, 0}, "json{}");
  const auto call = read_binary(called);
  ASSERT_TRUE(call);
  EXPECT_EQ(std::get<CallService>(*call).service, 5u);
  EXPECT_EQ(std::get<CallService>(*call).call, 0x109u);
  EXPECT_EQ(std::get<CallService>(*call).encoding, "json");
  EXPECT_EQ(text_of(std::get<CallService>(*call).bytes), "{}");
  // Pause at half speed (0.5 is 0x3F000000), go to 258 ns.
  const auto control = read_binary(bytes({3, 1, 0, 0, 0, 0x3F, 1, 2, 1, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0}, "ab"));
  ASSERT_TRUE(control) << control.error().text();
  const auto& playback = std::get<PlaybackControl>(*control);
  EXPECT_FALSE(playback.play);
  EXPECT_EQ(playback.speed, 0.5);
  EXPECT_EQ(playback.seek_ns, 258u);
  EXPECT_EQ(playback.id, "ab");
  const auto on = read_binary(bytes({3, 0, 0, 0, 0, 0x3F, 0, 2, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(on);
  EXPECT_TRUE(std::get<PlaybackControl>(*on).play);
  EXPECT_EQ(std::get<PlaybackControl>(*on).seek_ns, std::nullopt);
}

TEST(Foxglove, TruncatedAndUnknownBytesAreRefused) {
  const std::vector<std::vector<std::byte>> whole{
      bytes({1, 0, 0, 0, 0}), bytes({2, 5, 0, 0, 0, 9, 1, 0, 0, 4, 0, 0, 0}, "json"),
      bytes({3, 1, 0, 0, 0, 0x3F, 1, 2, 1, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0}, "ab")};
  for (const auto& each : whole) {
    EXPECT_TRUE(read_binary(each));
    for (std::size_t n = 0; n < each.size(); ++n) EXPECT_FALSE(read_binary(std::span(each).first(n))) << n;
  }
  for (int op = 0; op < 256; ++op) {
    const auto result = read_binary(bytes({op, 0, 0, 0, 0}));
    EXPECT_EQ(static_cast<bool>(result), op == 1) << op;
    if (op > 3) { EXPECT_NE(result.error().text().find("op " + std::to_string(op)), std::string::npos); }
  }
  auto longer = whole[2];
  longer.push_back({});
  EXPECT_FALSE(read_binary(longer));
  // Not a number as speed; an unknown command.
  EXPECT_FALSE(read_binary(bytes({3, 0, 0, 0, 0xC0, 0x7F, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})));
  EXPECT_FALSE(read_binary(bytes({3, 2, 0, 0, 0, 0x3F, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})));
  // An encoding that would be 4 GB long, and one longer than a name.
  EXPECT_FALSE(read_binary(bytes({2, 5, 0, 0, 0, 9, 1, 0, 0, 255, 255, 255, 255}, "json")));
  EXPECT_FALSE(read_binary(bytes({2, 5, 0, 0, 0, 9, 1, 0, 0, 1, 16, 0, 0}, std::string(5000, 'x'))));
  EXPECT_FALSE(read_binary(std::vector<std::byte>(most_binary_bytes + 1, std::byte{1})));
}

TEST(Foxglove, WhatIsWrongWithATextIsSaidInOneSentence) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "a message that is not JSON"},
      {"{", "a message that is not JSON"},
      {R"({"op":"subscribe"} {})", "a message that is not JSON"},
      {"{\"op\":\"\xff\"}", "a message that is not JSON"},
      {"[1]", "a message that is not a JSON object"},
      {R"({"id":1})", "a message without an 'op'"},
      {R"({"op":1})", "a message without an 'op'"},
      {R"({"op":"subscrib"})", "there is no op 'subscrib'; did you mean 'subscribe'?"},
      {R"({"op":"subscribe"})", "subscribe: 'subscriptions' is missing"},
      {R"({"op":"subscribe","subscriptions":{}})", "subscribe: 'subscriptions' must be a list"},
      {R"({"op":"subscribe","subscriptions":[1]})", "subscribe: subscriptions[0] is not an object"},
      {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2}]})",
       "subscribe: subscriptions[1]: 'channelId' is missing"},
      {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":1,"channelId":2}]})",
       "subscribe: 'subscriptions' has 1 twice"},
      {R"({"op":"subscribe","op":"unsubscribe"})", "a message with the key 'op' twice"},
      {R"({"op":"unsubscribe","subscriptionIds":[-1]})",
       "unsubscribe: 'subscriptionIds' must be a whole number from 0 to 4294967295"},
      {R"({"op":"unsubscribe","subscriptionIds":[4294967296]})",
       "unsubscribe: 'subscriptionIds' must be a whole number from 0 to 4294967295"},
      {R"({"op":"unsubscribe","subscriptionIds":[1.0]})",
       "unsubscribe: 'subscriptionIds' must be a whole number from 0 to 4294967295"},
      {R"({"op":"unsubscribe","subscriptionIds":["1"]})",
       "unsubscribe: 'subscriptionIds' must be a whole number from 0 to 4294967295"},
      {R"({"op":"unsubscribe","subscriptionIds":[2,1,2]})", "unsubscribe: 'subscriptionIds' has 2 twice"},
      {R"({"op":"advertise","channels":[{"id":1,"topic":5,"encoding":"cdr"}]})",
       "advertise: channels[0]: 'topic' must be a text"},
      {R"({"op":"fetchAsset","uri":"x"})", "fetchAsset: 'requestId' is missing"},
      {R"({"op":"setParameters","parameters":[{"name":"a","value":{}}]})",
       "setParameters: parameters[0]: 'value' must be a number, a text, true, false, or a list"},
      {R"({"op":"setParameters","parameters":[{"name":"a","value":["x",1]}]})",
       "setParameters: parameters[0]: 'value' mixes texts with other things"},
      {R"({"op":"setParameters","parameters":[{"name":"a","value":[1,true]}]})",
       "setParameters: parameters[0]: 'value' must be a list of numbers, or of texts"},
      {R"({"op":"setParameters","parameters":[{"name":"a","value":"x","type":"float64"}]})",
       "setParameters: parameters[0]: 'value' is no 'float64' (types are float64, float64_array, "
       "byte_array, or none)"},
      {R"({"op":"setParameters","parameters":[{"name":"a","value":1e999}]})", "a message that is not JSON"},
      {R"({"op":"setParameters","parameters":[{"name":"a","value":1},{"name":"a","value":2}]})",
       "setParameters: parameters[1]: 'a' is set twice"},
  };
  for (const auto& [text, expected] : cases) EXPECT_EQ(error_of(text), expected) << text;
}

TEST(Foxglove, LimitsHoldBeforeAnythingIsMade) {
  const auto nested = [](int depth) {
    return R"({"op":"subscribeConnectionGraph","x":)" + std::string(static_cast<std::size_t>(depth), '[') +
           std::string(static_cast<std::size_t>(depth), ']') + "}";
  };
  EXPECT_TRUE(read_text(nested(31)));  // the object itself is one level
  EXPECT_EQ(error_of(nested(32)), "a message nested more than 32 deep");
  EXPECT_EQ(error_of(nested(500'000)), "a message nested more than 32 deep");
  // Brackets in texts are no nesting, whatever is escaped in them.
  EXPECT_TRUE(
      read_text(R"({"op":"subscribeConnectionGraph","x":"\"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["})"));
  EXPECT_EQ(error_of(std::string(most_text_bytes + 1, ' ')), "a message of 1048577 bytes; at most 1048576");
  std::string many = R"({"op":"unsubscribe","subscriptionIds":[0)";
  for (std::size_t i = 1; i < most_entries; ++i) many += "," + std::to_string(i);
  EXPECT_EQ(read_as<Unsubscribe>(many + "]}").ids.size(), most_entries);
  EXPECT_EQ(error_of(many + ",20000]}"), "unsubscribe: 'subscriptionIds' has more than 20000 entries");
  EXPECT_EQ(error_of("{\"x\":[0" +
                     [] {
                       std::string zeros;
                       for (int i = 0; i < 170'000; ++i) zeros += ",0";
                       return zeros;
                     }() +
                     "]}"),
            "a message of more than 160000 values");
  EXPECT_EQ(error_of(R"({"op":"fetchAsset","requestId":1,"uri":")" + std::string(4097, 'x') + "\"}"),
            "fetchAsset: 'uri' is longer than 4096 bytes");
  // What a sentence repeats of the client's is short and printable.
  EXPECT_EQ(error_of("{\"op\":\"" + std::string(5000, 'x') + "\"}").find(std::string(61, 'x')),
            std::string::npos);
}

TEST(Foxglove, TheServerSaysItAsTheSpecificationHasIt) {
  EXPECT_EQ(
      Json::parse(server_info({"arena", {"time"}, {"cdr", "json"}, {{"ROS_DISTRO", "humble"}}, "s1"})),
      Json::parse(
          R"({"op":"serverInfo","name":"arena","capabilities":["time"],"supportedEncodings":["cdr","json"],
                            "metadata":{"ROS_DISTRO":"humble"},"sessionId":"s1"})"));
  EXPECT_EQ(Json::parse(status(Level::error, "no \xff", "p")),
            Json::parse("{\"op\":\"status\",\"level\":2,\"message\":\"no \xEF\xBF\xBD\",\"id\":\"p\"}"));
  EXPECT_EQ(Json::parse(status(Level::info, "x")), Json::parse(R"({"op":"status","level":0,"message":"x"})"));
  const Channel channel{3, "/scan", "cdr", "sensor_msgs/msg/LaserScan", "float32 x", "ros2msg"};
  EXPECT_EQ(Json::parse(advertise({&channel, 1})),
            Json::parse(R"({"op":"advertise","channels":[{"id":3,"topic":"/scan","encoding":"cdr",
                "schemaName":"sensor_msgs/msg/LaserScan","schema":"float32 x","schemaEncoding":"ros2msg"}]})"));
  const std::vector<std::uint32_t> ids{4, 5};
  EXPECT_EQ(Json::parse(unadvertise(ids)), Json::parse(R"({"op":"unadvertise","channelIds":[4,5]})"));
  EXPECT_EQ(Json::parse(unadvertise_services(ids)),
            Json::parse(R"({"op":"unadvertiseServices","serviceIds":[4,5]})"));
  const Service service{1,
                        "/s",
                        "p/srv/S",
                        {"cdr", "p/srv/S_Request", "ros2msg", "string a"},
                        {"json", "p/srv/S_Response", "jsonschema", "{}"}};
  EXPECT_EQ(Json::parse(advertise_services({&service, 1})),
            Json::parse(R"({"op":"advertiseServices","services":[{"id":1,"name":"/s","type":"p/srv/S",
                "request":{"encoding":"cdr","schemaName":"p/srv/S_Request","schemaEncoding":"ros2msg","schema":"string a"},
                "response":{"encoding":"json","schemaName":"p/srv/S_Response","schemaEncoding":"jsonschema","schema":"{}"}}]})"));
  EXPECT_EQ(Json::parse(service_failure(1, 2, "no")),
            Json::parse(R"({"op":"serviceCallFailure","serviceId":1,"callId":2,"message":"no"})"));
  const Graph graph{{{"/scan", {"rover/laser"}}}, {{"/scan", {"c1", "c2"}}}, {{"/s", {"sandlot"}}}};
  const Graph gone{{{"/a", {}}, {"/b", {}}}, {{"/b", {}}}, {{"/t", {}}}};
  EXPECT_EQ(
      Json::parse(graph_update(graph, gone)),
      Json::parse(
          R"({"op":"connectionGraphUpdate","publishedTopics":[{"name":"/scan","publisherIds":["rover/laser"]}],
                "subscribedTopics":[{"name":"/scan","subscriberIds":["c1","c2"]}],
                "advertisedServices":[{"name":"/s","providerIds":["sandlot"]}],
                "removedTopics":["/a","/b"],"removedServices":["/t"]})"));
}

TEST(Foxglove, ParametersKeepTheirTypes) {
  const std::vector<Parameter> all{{"f", 2.0, "float64"},
                                   {"b", false, ""},
                                   {"t", std::string("word"), ""},
                                   {"l", std::vector<double>{1, 0.5}, "float64_array"},
                                   {"w", std::vector<std::string>{"x"}, ""},
                                   {"y", std::string("AAE="), "byte_array"},
                                   {"none", {}, ""}};
  const std::string said = parameter_values(all, "q");
  EXPECT_EQ(
      Json::parse(said),
      Json::parse(R"({"op":"parameterValues","id":"q","parameters":[{"name":"f","value":2.0,"type":"float64"},
                {"name":"b","value":false},{"name":"t","value":"word"},{"name":"l","value":[1.0,0.5],"type":"float64_array"},
                {"name":"w","value":["x"]},{"name":"y","value":"AAE=","type":"byte_array"},{"name":"none"}]})"));
  EXPECT_FALSE(Json::parse(parameter_values(all)).contains("id"));
  // A client that sends them back as they came sets the same.
  Json back = Json::parse(said);
  back["op"] = "setParameters";
  const auto set = read_as<SetParameters>(back.dump());
  ASSERT_EQ(set.parameters.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(set.parameters[i].value, all[i].value) << all[i].name;
    EXPECT_EQ(set.parameters[i].type, all[i].type);
  }
}

TEST(Foxglove, TheServerSendsBytes) {
  const auto header = message_header(0x04030201, Time{0x0807060504030201});
  EXPECT_EQ(std::vector(header.begin(), header.end()), bytes({1, 1, 2, 3, 4, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(time(Time{258}), bytes({2, 2, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(time(Time{-5}), bytes({2, 0, 0, 0, 0, 0, 0, 0, 0}));  // there is no time before 0 on the wire
  EXPECT_EQ(service_response(1, 2, "cdr", bytes({9, 8})),
            bytes({3, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 'c', 'd', 'r', 9, 8}));
  EXPECT_EQ(asset(7, bytes({1, 2, 3})), bytes({4, 7, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3}));
  EXPECT_EQ(asset_error(7, "no"), bytes({4, 7, 0, 0, 0, 1, 2, 0, 0, 0, 'n', 'o'}));
}

TEST(Foxglove, DamagedMessagesAreRefusedOrReadButNothingWorse) {
  const std::string seeds[] = {
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]})",
      R"({"op":"setParameters","id":"s","parameters":[{"name":"f","value":[1,2],"type":"float64_array"}]})",
      std::string("\x02\x05\0\0\0\x09\0\0\0\x04\0\0\0json{}", 19)};
  Stream stream(1, 2, Purpose::placement, 3);
  int refused = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::string text = seeds[round % 3];
    for (int i = 0; i < 1 + round % 4; ++i)
      text[static_cast<std::size_t>(stream.uniform() * static_cast<double>(text.size()))] = static_cast<char>(
          static_cast<std::uint8_t>(stream.uniform() * 256));
    const auto as_text = read_text(text);
    const auto as_bytes = read_binary(std::as_bytes(std::span(text)));
    EXPECT_TRUE(as_text || !as_text.error().what.empty());
    EXPECT_TRUE(as_bytes || !as_bytes.error().what.empty());
    refused += !as_text;
  }
  EXPECT_GT(refused, 10'000);
}

}  // namespace
}  // namespace sandlot::foxglove
