// ros2msg texts of the few types that the mock server tells.
const LINE = `\n${'='.repeat(80)}\n`;
const TIME = `${LINE}MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n`;
const HEADER = `${LINE}MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n`;

export const SCHEMAS = {
  'sensor_msgs/msg/LaserScan': `std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\nfloat32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\nfloat32[] intensities\n${HEADER}${TIME}`,
  'rosgraph_msgs/msg/Clock': `builtin_interfaces/Time clock\n${TIME}`,
  'rcl_interfaces/msg/Log': `builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\nstring function\nuint32 line\n${TIME}`,
  'sandlot_msgs/msg/Samples': `builtin_interfaces/Time stamp\nfloat64[] values\n${TIME}`,
};

export const SERVICES = [
  { name: '/sandlot/console', type: 'sandlot_msgs/srv/Console', request: 'string line\n', response: 'bool ok\nstring text\n' },
  { name: '/sandlot/complete', type: 'sandlot_msgs/srv/Complete', request: 'string line\n', response: 'string[] candidates\n' },
  { name: '/sandlot/watch', type: 'sandlot_msgs/srv/Watch', request: 'string[] values\nfloat64 rate_hz\n', response: 'bool ok\nstring text\nstring topic\n' },
  { name: '/sandlot/disconnect_client', type: 'sandlot_msgs/srv/DisconnectClient', request: 'uint64 client\n', response: 'bool ok\nstring text\n' },
  { name: '/sandlot/restart_program', type: 'sandlot_msgs/srv/RestartProgram', request: 'string program\n', response: 'bool ok\nstring text\n' },
];
