#pragma once
/// Types of the services that devices offer (devices/device_service.h), as pairs of messages: std_srvs and robot_localization.
#include <string>

#include "messages/geometry_msgs.h"

namespace sandlot::msg::std_srvs {

/// Does the one thing that the service is named after.
struct Trigger {
  static constexpr const char* ros_type = "std_srvs/srv/Trigger";
  struct Request {
    static constexpr const char* ros_type = "std_srvs/srv/Trigger_Request";
    static void fields(auto&, auto&&) {}
  };
  struct Response {
    static constexpr const char* ros_type = "std_srvs/srv/Trigger_Response";
    bool success = false;
    std::string message;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"success", "", "Whether it was done."}, s.success);
      visit(Field{"message", "", "Result, or the reason of a failure."}, s.message);
    }
  };
};

}  // namespace sandlot::msg::std_srvs

namespace sandlot::msg::robot_localization {

/// Sets the pose of an estimate.
struct SetPose {
  static constexpr const char* ros_type = "robot_localization/srv/SetPose";
  struct Request {
    static constexpr const char* ros_type = "robot_localization/srv/SetPose_Request";
    PoseWithCovarianceStamped pose;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"pose", "", "Requested pose, in the frame of the estimate."}, s.pose);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "robot_localization/srv/SetPose_Response";
    static void fields(auto&, auto&&) {}
  };
};

}  // namespace sandlot::msg::robot_localization
