/// Service types against the text of their .srv files, written down here.
#include "messages/services.h"

#include <gtest/gtest.h>

#include "messages/registry.h"

namespace sandlot {
namespace {

/// What a schema says of the type itself, without those that it is made of.
std::string own_part(const MessageInfo& info) {
  return info.schema.substr(0, info.schema.find(std::string(80, '=')));
}

TEST(Services, AreFoundByNameAndTheErrorNamesTheNearest) {
  const auto console = find_service("sandlot_msgs/srv/Console");
  ASSERT_TRUE(console);
  EXPECT_EQ((*console)->request->name, "sandlot_msgs/srv/Console_Request");
  EXPECT_EQ((*console)->response->name, "sandlot_msgs/srv/Console_Response");
  EXPECT_EQ(*find_service("sandlot_msgs/Console"), *console);
  const auto wrong = find_service("sandlot_msgs/srv/Konsole");
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().text(),
            "there is no service type 'sandlot_msgs/srv/Konsole'; did you mean 'sandlot_msgs/srv/Console'?");
  for (const ServiceInfo& service : all_services()) {
    EXPECT_EQ(*find_message(service.name + "_Request"), service.request);
    EXPECT_EQ(*find_message(service.name + "_Response"), service.response);
  }
}

TEST(Services, HaveTheMembersOfTheirSrvFiles) {
  const struct {
    const char *name, *request, *response;
  } expected[] = {
      {"controller_manager_msgs/srv/ConfigureController", "string name\n", "bool ok\n"},
      {"controller_manager_msgs/srv/ListControllers", "",
       "controller_manager_msgs/ControllerState[] controller\n"},
      {"controller_manager_msgs/srv/SwitchController",
       "int32 BEST_EFFORT=1\nint32 STRICT=2\nint32 AUTO=3\nint32 FORCE_AUTO=4\nstring[] "
       "activate_controllers\nstring[] deactivate_controllers\nint32 strictness\nbool "
       "activate_asap\nbuiltin_interfaces/Duration timeout\n",
       "bool ok\nstring message\n"},
      {"controller_manager_msgs/srv/UnloadController", "string name\n", "bool ok\n"},
      {"robot_localization/srv/SetPose", "geometry_msgs/PoseWithCovarianceStamped pose\n", ""},
      {"sandlot_msgs/srv/Complete", "string line\n", "string[] candidates\n"},
      {"sandlot_msgs/srv/Console", "string line\n", "bool ok\nstring text\n"},
      {"sandlot_msgs/srv/Decisions", "string topic\n", "sandlot_msgs/RefereeDecision[] decisions\n"},
      {"sandlot_msgs/srv/DisconnectClient", "uint64 client\n", "bool ok\nstring text\n"},
      {"sandlot_msgs/srv/LoadController", "string name\nstring kind\nstring parameters\nstring file\n",
       "bool ok\n"},
      {"sandlot_msgs/srv/MatchTrack", "",
       "string[] robots\nstring[] teams\nfloat64[] times\nint32[] places\nfloat64[] touch_times\nstring[] "
       "touches\n"},
      {"sandlot_msgs/srv/RestartProgram", "string program\n", "bool ok\nstring text\n"},
      {"sandlot_msgs/srv/Watch", "string[] values\nfloat64 rate_hz\n",
       "bool ok\nstring text\nstring topic\n"},
      {"simulation_interfaces/srv/DeleteEntity", "string entity\n", "simulation_interfaces/Result result\n"},
      {"simulation_interfaces/srv/GetAvailableWorlds",
       "string[] additional_sources\nsimulation_interfaces/TagsFilter filter\nbool offline_only\nbool "
       "continue_on_error\n",
       "uint8 DEFAULT_SOURCES_FAILED=101\nsimulation_interfaces/Result "
       "result\nsimulation_interfaces/WorldResource[] worlds\n"},
      {"simulation_interfaces/srv/GetCurrentWorld", "",
       "uint8 NO_WORLD_LOADED=101\nsimulation_interfaces/Result result\nsimulation_interfaces/WorldResource "
       "world\n"},
      {"simulation_interfaces/srv/GetEntities", "simulation_interfaces/EntityFilters filters\n",
       "simulation_interfaces/Result result\nstring[] entities\n"},
      {"simulation_interfaces/srv/GetEntitiesStates", "simulation_interfaces/EntityFilters filters\n",
       "simulation_interfaces/Result result\nstring[] entities\nsimulation_interfaces/EntityState[] "
       "states\n"},
      {"simulation_interfaces/srv/GetEntityBounds", "string entity\n",
       "simulation_interfaces/Result result\nsimulation_interfaces/Bounds bounds\n"},
      {"simulation_interfaces/srv/GetEntityInfo", "string entity\n",
       "simulation_interfaces/Result result\nsimulation_interfaces/EntityInfo info\n"},
      {"simulation_interfaces/srv/GetEntityState", "string entity\n",
       "simulation_interfaces/Result result\nsimulation_interfaces/EntityState state\n"},
      {"simulation_interfaces/srv/GetNamedPoseBounds", "string name\n",
       "simulation_interfaces/Result result\nsimulation_interfaces/Bounds bounds\n"},
      {"simulation_interfaces/srv/GetNamedPoses", "simulation_interfaces/TagsFilter tags\n",
       "simulation_interfaces/Result result\nsimulation_interfaces/NamedPose[] poses\n"},
      {"simulation_interfaces/srv/GetSimulationState", "",
       "simulation_interfaces/SimulationState state\nsimulation_interfaces/Result result\n"},
      {"simulation_interfaces/srv/GetSimulatorFeatures", "",
       "simulation_interfaces/SimulatorFeatures features\n"},
      {"simulation_interfaces/srv/GetSpawnables", "string[] sources\n",
       "simulation_interfaces/Result result\nsimulation_interfaces/Spawnable[] spawnables\n"},
      {"simulation_interfaces/srv/LoadWorld",
       "simulation_interfaces/Resource world_resource\nbool fail_on_unsupported_element\nbool "
       "ignore_missing_or_unsupported_assets\n",
       "uint8 UNSUPPORTED_FORMAT=101\nuint8 NO_RESOURCE=102\nuint8 RESOURCE_PARSE_ERROR=103\nuint8 "
       "MISSING_ASSETS=104\nuint8 UNSUPPORTED_ASSETS=105\nuint8 "
       "UNSUPPORTED_ELEMENTS=106\nsimulation_interfaces/Result result\nsimulation_interfaces/WorldResource "
       "world\n"},
      {"simulation_interfaces/srv/ResetSimulation",
       "uint8 SCOPE_DEFAULT=0\nuint8 SCOPE_TIME=1\nuint8 SCOPE_STATE=2\nuint8 SCOPE_SPAWNED=4\nuint8 "
       "SCOPE_ALL=255\nuint8 scope\n",
       "simulation_interfaces/Result result\n"},
      {"simulation_interfaces/srv/SetEntityInfo", "string entity\nsimulation_interfaces/EntityInfo info\n",
       "simulation_interfaces/Result result\n"},
      {"simulation_interfaces/srv/SetEntityState",
       "string entity\nsimulation_interfaces/EntityState state\nbool set_pose\nbool set_twist\nbool "
       "set_acceleration\n",
       "uint8 INVALID_POSE=101\nsimulation_interfaces/Result result\n"},
      {"simulation_interfaces/srv/SetSimulationState", "simulation_interfaces/SimulationState state\n",
       "uint8 ALREADY_IN_TARGET_STATE=101\nuint8 STATE_TRANSITION_ERROR=102\nuint8 "
       "INCORRECT_TRANSITION=103\nsimulation_interfaces/Result result\n"},
      {"simulation_interfaces/srv/SpawnEntities", "simulation_interfaces/SpawnEntity[] spawn_requests\n",
       "uint8 ENTITIES_SPAWN_FAILED=150\nsimulation_interfaces/Result "
       "result\nsimulation_interfaces/SpawnResult[] results\n"},
      {"simulation_interfaces/srv/SpawnEntity",
       "string name\nbool allow_renaming\nsimulation_interfaces/Resource entity_resource\nstring "
       "entity_namespace\ngeometry_msgs/PoseStamped initial_pose\n",
       "uint8 NAME_NOT_UNIQUE=101\nuint8 NAME_INVALID=102\nuint8 UNSUPPORTED_FORMAT=103\nuint8 "
       "NO_RESOURCE=104\nuint8 NAMESPACE_INVALID=105\nuint8 RESOURCE_PARSE_ERROR=106\nuint8 "
       "MISSING_ASSETS=107\nuint8 UNSUPPORTED_ASSETS=108\nuint8 "
       "INVALID_POSE=109\nsimulation_interfaces/Result result\nstring entity_name\n"},
      {"simulation_interfaces/srv/StepSimulation", "uint64 steps\n", "simulation_interfaces/Result result\n"},
      {"simulation_interfaces/srv/UnloadWorld", "",
       "uint8 NO_WORLD_LOADED=101\nsimulation_interfaces/Result result\n"},
      {"std_srvs/srv/Trigger", "", "bool success\nstring message\n"},
  };
  ASSERT_EQ(all_services().size(), std::size(expected));
  for (std::size_t i = 0; i < std::size(expected); ++i) {
    const ServiceInfo& service = all_services()[i];
    EXPECT_EQ(service.name, expected[i].name);
    EXPECT_EQ(own_part(*service.request), expected[i].request) << service.name;
    EXPECT_EQ(own_part(*service.response), expected[i].response) << service.name;
  }
}

TEST(Services, RequestsComeAsJsonAndWhatIsLeftOutHasItsDefault) {
  const ServiceInfo* const step = *find_service("simulation_interfaces/srv/StepSimulation");
  const auto request = message_from_json(*step->request, "{}");
  ASSERT_TRUE(request);
  EXPECT_EQ(static_cast<const msg::simulation::StepSimulation::Request*>(request->data())->steps, 1u);
  const auto wrong = message_from_json(*step->request, R"({"stepps": 3})");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().text().find("steps"), std::string::npos) << wrong.error().text();
}

TEST(Services, AnEmptyRequestIsOneByteOfCdr) {
  std::vector<std::byte> cdr;
  const auto features = find_service("simulation_interfaces/srv/GetSimulatorFeatures");
  ASSERT_TRUE(features);
  AnyMessage(*(*features)->request).to_cdr(cdr);
  // 4 bytes tell the encoding; ROS 2 gives a struct without members one of its own.
  EXPECT_EQ(cdr.size(), 5u);
}

}  // namespace
}  // namespace sandlot
