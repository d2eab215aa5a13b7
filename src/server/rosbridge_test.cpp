/// rosbridge over TCP and WebSocket, as clients of ROS speak it.
#include "messages/cbor.h"
#include "server/test_bridge.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

TEST(Rosbridge, BringsMessagesAndTakesCommandsOverTcp) {
  Running run(arena("planar", 1, ""), {.pace = {1.0}});
  Bridge bridge(run.url());
  bridge.send({{"op", "subscribe"}, {"topic", "rover1/laser/ranges"}, {"type", "sensor_msgs/LaserScan"}});
  bridge.send({{"op", "subscribe"}, {"topic", "/clock"}});
  run.go();
  json scan;
  while (scan.is_null()) {
    const json message = bridge.next("publish");
    ASSERT_FALSE(message.is_null());
    if (message["topic"] == "/rover1/laser/ranges") scan = message["msg"];
  }
  EXPECT_EQ(scan["ranges"].size(), 61u);
  EXPECT_TRUE(scan["header"]["stamp"].contains("nanosec"));
  // A topic without its first slash, a type in the form of ROS 1, without `advertise`.
  const json before = bridge.call("/get_entity_state", {{"entity", "rover1"}});
  ASSERT_EQ(before["result"], true) << before.dump();
  for (int i = 0; i < 50; ++i) {
    bridge.send({{"op", "publish"}, {"topic", "rover1/cmd_vel"}, {"msg", {{"linear", {{"x", 0.3}}}}}});
    std::this_thread::sleep_for(10ms);
  }
  const json after = bridge.call("/get_entity_state", {{"entity", "rover1"}});
  const auto x = [](const json& answer) {
    return answer["values"]["state"]["pose"]["position"]["x"].get<double>();
  };
  const auto y = [](const json& answer) {
    return answer["values"]["state"]["pose"]["position"]["y"].get<double>();
  };
  const double dx = x(after) - x(before), dy = y(after) - y(before);
  EXPECT_GT(std::sqrt(dx * dx + dy * dy), 0.03);
}

TEST(Rosbridge, AnswersRosapiAndRefusesWithTheNearestName) {
  Running run(arena("planar", 1, ""), {.paused = true});
  run.go();
  Bridge bridge(run.url());
  const json topics = bridge.call("rosapi/topics", json::object())["values"]["topics"];
  EXPECT_NE(std::find(topics.begin(), topics.end(), "/rover1/laser/ranges"), topics.end());
  const json type = bridge.call("/rosapi/topic_type", {{"topic", "/rover1/laser/ranges"}});
  EXPECT_EQ(type["values"]["type"], "sensor_msgs/msg/LaserScan");
  const json raw = bridge.call("/rosapi/topics_and_raw_types", json::object());
  EXPECT_EQ(raw["values"]["topics"].size(), raw["values"]["typedefs_full_text"].size());

  const auto refused = [&](const json& message) {
    bridge.send(message);
    return bridge.next("status")["msg"].get<std::string>();
  };
  EXPECT_EQ(refused({{"op", "subscribe"}, {"topic", "/rover1/laser/range"}}),
            "there is no topic '/rover1/laser/range'; did you mean '/rover1/laser/ranges'?");
  EXPECT_EQ(refused({{"op", "subscribe"}, {"topic", "/rover1/laser/ranges"}, {"type", "nav_msgs/Odometry"}}),
            "'/rover1/laser/ranges' carries sensor_msgs/msg/LaserScan, not nav_msgs/Odometry");
  EXPECT_EQ(refused({{"op", "dance"}}), "the operation 'dance' is not known here");
  EXPECT_EQ(refused({{"op", "publish"}, {"topic", "/rover1/drive"}}), "'msg' of the message is missing");
  EXPECT_NE(refused({{"op", "publish"}, {"topic", "/rover1/drive"}, {"msg", {{"linaer", 1}}}}).find("linear"),
            std::string::npos);
  const json failed = bridge.call("/get_entity_states", json::object());
  EXPECT_EQ(failed["result"], false);
  EXPECT_EQ(failed["values"], "there is no service '/get_entity_states'; did you mean '/get_entity_state'?");
  // Silence that was asked for.
  bridge.send({{"op", "set_level"}, {"level", "none"}});
  bridge.send({{"op", "dance"}});
  bridge.send({{"op", "call_service"}, {"service", "/rosapi/get_time"}, {"id", "7"}});
  EXPECT_EQ(bridge.take()["op"], "service_response");
}

TEST(Rosbridge, RosapiKnowsTypesNodesAndParameters) {
  Running run(arena("planar", 1, "wander"), {.pace = {1.0}});
  run.go();
  Bridge bridge(run.url());
  const auto ask = [&](const std::string& service, const json& args) {
    return bridge.call("/rosapi/" + service, args)["values"];
  };
  const json twist = ask("message_details", {{"type", "geometry_msgs/Twist"}})["typedefs"];
  ASSERT_EQ(twist.size(), 2u) << "a Twist is made of Vector3";
  EXPECT_EQ(twist[0]["type"], "geometry_msgs/Twist");
  EXPECT_EQ(twist[0]["fieldnames"], json({"linear", "angular"}));
  EXPECT_EQ(twist[0]["fieldtypes"], json({"geometry_msgs/Vector3", "geometry_msgs/Vector3"}));
  EXPECT_EQ(twist[0]["fieldarraylen"], json({-1, -1}));
  EXPECT_EQ(twist[1]["fieldtypes"], json({"float64", "float64", "float64"}));
  const json scan = ask("message_details", {{"type", "sensor_msgs/msg/LaserScan"}})["typedefs"][0];
  EXPECT_EQ(scan["fieldarraylen"].back(), 0) << "intensities are a list";
  EXPECT_TRUE(ask("message_details", {{"type", "no/Such"}})["typedefs"].empty());
  const json request = ask("service_request_details",
                           {{"type", "simulation_interfaces/srv/ResetSimulation"}});
  EXPECT_EQ(request["typedefs"][0]["fieldnames"], json({"scope"}));
  EXPECT_EQ(request["typedefs"][0]["constnames"][4], "SCOPE_ALL");
  EXPECT_EQ(request["typedefs"][0]["constvalues"][4], "255");
  const json response = ask("service_response_details", {{"type", "sandlot_msgs/Console"}});
  EXPECT_EQ(response["typedefs"][0]["fieldnames"], json({"ok", "text"}));
  EXPECT_EQ(ask("services_for_type", {{"type", "sandlot_msgs/Console"}})["services"],
            json({"/sandlot/console"}));

  const json nodes = ask("nodes", json::object())["nodes"];
  for (const char* node : {"/sandlot", "/rover1/laser", "/rover1/controller"})
    EXPECT_EQ(std::count(nodes.begin(), nodes.end(), node), 1) << node;
  const json laser = ask("node_details", {{"node", "/rover1/laser"}});
  const json& published = laser["publishing"];
  EXPECT_EQ(std::count(published.begin(), published.end(), "/rover1/laser/ranges"), 1);
  for (const json& each : published)
    EXPECT_EQ(each.get<std::string>().rfind("/rover1/laser/", 0), 0u) << each;
  EXPECT_TRUE(laser["subscribing"].empty());
  EXPECT_EQ(ask("publishers", {{"topic", "/rover1/laser/ranges"}})["publishers"], json({"/rover1/laser"}));
  EXPECT_EQ(ask("subscribers", {{"topic", "/rover1/laser/ranges"}})["subscribers"],
            json({"/rover1/controller"}));
  EXPECT_EQ(ask("service_node", {{"service", "/get_entities"}})["node"], "/sandlot");

  const json names = ask("get_param_names", json::object())["names"];
  EXPECT_EQ(std::count(names.begin(), names.end(), "rover1/laser.noise.white"), 1);
  EXPECT_EQ(ask("get_param", {{"name", "rover1/laser.noise.white"}})["value"], "0.01") << "JSON in a text";
  EXPECT_EQ(ask("set_param", {{"name", "/rover1/laser.noise.white"}, {"value", "0.5"}})["successful"], true);
  EXPECT_EQ(ask("get_param", {{"name", "rover1/laser.noise.white"}})["value"], "0.5");
  EXPECT_EQ(ask("has_param", {{"name", "rover1/laser.noise.white"}})["exists"], true);
  EXPECT_EQ(ask("has_param", {{"name", "rover1/laser.noise.black"}})["exists"], false);
  EXPECT_EQ(ask("get_param", {{"name", "none"}, {"default", "7"}})["value"], "7");
  EXPECT_EQ(bridge.call("/rosapi/get_param", {{"name", "none"}})["result"], false);
  const json wrong = bridge.call("/rosapi/set_param",
                                 {{"name", "rover1/laser.noise.white"}, {"value", "-1"}});
  EXPECT_EQ(wrong["result"], false);
  EXPECT_NE(wrong["values"].get<std::string>().find("must be in"), std::string::npos) << wrong;
  EXPECT_EQ(bridge.call("/rosapi/delete_param", {{"name", "none"}})["result"], false);
  EXPECT_EQ(bridge.call("/rosapi/set_param", {{"name", "x"}, {"value", std::string(2000, '[')}})["result"],
            false);
  EXPECT_EQ(bridge.call("/rosapi/dance", json::object())["result"], false);
}

TEST(Rosbridge, SendsCborFragmentsAndThrottlesOverWebSocket) {
  Running run(arena("planar", 1, ""), {.paused = true});
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(run.session.simulation().tick());
  run.go();
  const std::string url = "ws" + run.url().substr(4);
  const auto made = WebSocketClient::connect(url, "", patience_s);
  ASSERT_TRUE(made) << made.error().text();
  WebSocketClient& client = **made;
  const auto send = [&](const json& message) {
    const std::string text = message.dump();
    EXPECT_TRUE(client.send(std::as_bytes(std::span(text)), true));
  };
  send({{"op", "subscribe"}, {"topic", "/rover1/laser/ranges"}, {"compression", "cbor"}});
  const auto publish = client.receive(patience_s);
  ASSERT_TRUE(publish && !publish->text);
  const auto document = parse_cbor(publish->bytes);
  ASSERT_TRUE(document) << document.error().text();
  EXPECT_EQ((*document)["op"], "publish");
  EXPECT_EQ((*document)["topic"], "/rover1/laser/ranges");
  EXPECT_TRUE((*document)["msg"]["ranges"].is_binary()) << "a typed array";

  send({{"op", "call_service"},
        {"service", "/rosapi/topics_and_raw_types"},
        {"id", "raw"},
        {"fragment_size", 1000}});
  std::map<int, std::string> parts;
  std::size_t total = 1;
  while (parts.size() < total) {
    const auto got = client.receive(patience_s);
    ASSERT_TRUE(got);
    if (!got->text) continue;
    const json part = json::parse(reinterpret_cast<const char*>(got->bytes.data()),
                                  reinterpret_cast<const char*>(got->bytes.data()) + got->bytes.size());
    ASSERT_EQ(part["op"], "fragment");
    total = part["total"];
    parts[part["num"]] = part["data"];
  }
  EXPECT_GT(total, 5u);
  std::string whole;
  for (const auto& [number, part] : parts) whole += part;
  EXPECT_EQ(json::parse(whole)["id"], "raw");

  // Fragments of the client.
  const std::string call = R"({"op":"call_service","service":"/rosapi/get_time","id":"in pieces"})";
  for (const int number : {1, 0})
    send({{"op", "fragment"},
          {"id", "a"},
          {"num", number},
          {"total", 2},
          {"data", number == 0 ? call.substr(0, 30) : call.substr(30)}});
  const auto answer = client.receive(patience_s);
  ASSERT_TRUE(answer);
  EXPECT_NE(std::string(reinterpret_cast<const char*>(answer->bytes.data()), answer->bytes.size())
                .find("in pieces"),
            std::string::npos);
}

TEST(Rosbridge, SurvivesWhatNoClientShouldSend) {
  Running run(arena("planar", 1, ""), {.paused = true});
  run.go();
  const auto refused = [&](const std::string& bytes) {
    Bridge bridge(run.url());
    bridge.send_text(bytes);
    return bridge.next("status")["msg"].get<std::string>();
  };
  EXPECT_EQ(refused("{\"op\":" + std::string(100'000, '[') + "}\n"), "a message nested more than 32 deep");
  EXPECT_EQ(refused("{}\n"), "'op' of the message is missing");
  EXPECT_EQ(refused("{} garbage"), "expected a JSON object");
  EXPECT_EQ(refused("{\"op\": 7}\n"), "'op' of the message is not a text");
  EXPECT_EQ(refused("{\"op\":\"x\",\"op\":\"y\"}\n"), "a message with the key 'op' twice");
  EXPECT_EQ(refused("{\"op\":\"fragment\",\"id\":\"a\",\"num\":0,\"total\":1000000000,\"data\":\"x\"}\n"),
            "a fragment's num and total do not fit");
  {  // An object that never ends is cut off at its limit.
    Bridge bridge(run.url());
    const std::string filler(1 << 16, 'a');
    bridge.send_text("{\"op\":\"");
    for (int i = 0; i < 40; ++i) bridge.send_text(filler);
    EXPECT_TRUE(bridge.ended());
  }
  Bridge good(run.url());
  EXPECT_EQ(good.call("/rosapi/get_ros_version", json::object())["values"]["version"], 2);
}

}  // namespace
}  // namespace sandlot::server::test
