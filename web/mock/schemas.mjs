// ros2msg texts of the few types that the mock server tells.
const LINE = `\n${'='.repeat(80)}\n`;
const TIME = `${LINE}MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n`;
const HEADER = `${LINE}MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n`;

const VECTOR = `${LINE}MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n`;
const TEAM = `${LINE}MSG: sandlot_msgs/RefereeTeam\nstring name\nstring title\nuint32 score\nuint32 robots\nuint32 yellow_cards\nuint32 red_cards\nbool attacks_positive_x\nfloat64 possession\n`;
const PLAYER = `${LINE}MSG: sandlot_msgs/RefereePlayer\nstring name\nstring team\nint32 number\nfloat64 x\nfloat64 y\nfloat64 yaw\n`;

export const SCHEMAS = {
  'sensor_msgs/msg/LaserScan': `std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\nfloat32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\nfloat32[] intensities\n${HEADER}${TIME}`,
  'rosgraph_msgs/msg/Clock': `builtin_interfaces/Time clock\n${TIME}`,
  'rcl_interfaces/msg/Log': `builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\nstring function\nuint32 line\n${TIME}`,
  'sandlot_msgs/msg/RefereeState': `std_msgs/Header header\nstring stage\nstring phase\nstring set_piece\nstring team\nbool in_play\nfloat64 clock\nfloat64 remaining\nsandlot_msgs/RefereeTeam[] teams\nstring last_touch\nuint64 commands\nuint64 decisions\n${HEADER}${TEAM}${TIME}`,
  'sandlot_msgs/msg/RefereeDecision': `std_msgs/Header header\nuint64 sequence\nuint64 tick\nstring stage\nfloat64 clock\nstring rule\nstring command\nstring team\nstring robot\nstring reason\ngeometry_msgs/Vector3 point\ngeometry_msgs/Vector3 ball\nuint32[] score\nsandlot_msgs/RefereePlayer[] players\n${HEADER}${VECTOR}${PLAYER}${TIME}`,
  'sandlot_msgs/msg/PlayerState': `std_msgs/Header header\nint32 number\nstring role\nstring intention\ngeometry_msgs/Vector3 pose\nfloat64 pose_std\ngeometry_msgs/Vector3 velocity\ngeometry_msgs/Vector3 target\ngeometry_msgs/Vector3 ball\ngeometry_msgs/Vector3 ball_velocity\nfloat64 ball_confidence\nbool ball_engaged\ngeometry_msgs/Vector3[] obstacles\nfloat64 battery\n${HEADER}${VECTOR}${TIME}`,
  'sensor_msgs/msg/CompressedImage': `std_msgs/Header header\nstring format\nuint8[] data\n${HEADER}${TIME}`,
  'sandlot_msgs/msg/Samples': `builtin_interfaces/Time stamp\nfloat64[] values\n${TIME}`,
};

export const SERVICES = [
  { name: '/sandlot/console', type: 'sandlot_msgs/srv/Console', request: 'string line\n', response: 'bool ok\nstring text\n' },
  { name: '/sandlot/complete', type: 'sandlot_msgs/srv/Complete', request: 'string line\n', response: 'string[] candidates\n' },
  { name: '/sandlot/watch', type: 'sandlot_msgs/srv/Watch', request: 'string[] values\nfloat64 rate_hz\n', response: 'bool ok\nstring text\nstring topic\n' },
  { name: '/sandlot/decisions', type: 'sandlot_msgs/srv/Decisions', request: 'string topic\n', response: `sandlot_msgs/RefereeDecision[] decisions\n${LINE}MSG: sandlot_msgs/RefereeDecision\nuint64 sequence\n` },
  { name: '/sandlot/match_track', type: 'sandlot_msgs/srv/MatchTrack', request: '', response: 'string[] robots\nstring[] teams\nfloat64[] times\nint32[] places\nfloat64[] touch_times\nstring[] touches\n' },
  { name: '/sandlot/disconnect_client', type: 'sandlot_msgs/srv/DisconnectClient', request: 'uint64 client\n', response: 'bool ok\nstring text\n' },
  { name: '/sandlot/restart_program', type: 'sandlot_msgs/srv/RestartProgram', request: 'string program\n', response: 'bool ok\nstring text\n' },
];
