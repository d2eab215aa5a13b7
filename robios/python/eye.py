"""RoBIOS-7 for programs in Python: `from eye import *`.

Functions have the names and arguments of C. What C puts behind pointers is returned as a list: `x, y, phi = VWGetPosition()`. Pictures are arrays of bytes
(ctypes), and may be given as bytes, lists or arrays of numpy, too.
"""
from __future__ import annotations

import ctypes
from typing import Any, Callable, List, Optional

_library = ctypes.CDLL("librobios7.so")

# Constants, as in types.h

NOKEY, KEY1, KEY2, KEY3, KEY4, ANYKEY = 0, 1, 2, 4, 8, 0xFFFFFFFF
PSD_FRONT, PSD_LEFT, PSD_RIGHT, PSD_BACK = 1, 2, 3, 4
QQVGA, QVGA, VGA, CAM1MP, CAMHD, CAM5MP, CUSTOM = 0, 1, 2, 3, 4, 5, 10
HELVETICA, TIMES, COURIER = 0, 1, 2
NORMAL, BOLD, ITALICS = 0, 1, 2
QQVGA_X, QQVGA_Y = 160, 120
QVGA_X, QVGA_Y = 320, 240
VGA_X, VGA_Y = 640, 480
CAM1MP_X, CAM1MP_Y = 1296, 730
CAMHD_X, CAMHD_Y = 1920, 1080
CAM5MP_X, CAM5MP_Y = 2592, 1944
QQVGA_PIXELS, QQVGA_SIZE = QQVGA_X * QQVGA_Y, QQVGA_X * QQVGA_Y * 3
QVGA_PIXELS, QVGA_SIZE = QVGA_X * QVGA_Y, QVGA_X * QVGA_Y * 3
VGA_PIXELS, VGA_SIZE = VGA_X * VGA_Y, VGA_X * VGA_Y * 3
CAM1MP_PIXELS, CAM1MP_SIZE = CAM1MP_X * CAM1MP_Y, CAM1MP_X * CAM1MP_Y * 3
CAMHD_PIXELS, CAMHD_SIZE = CAMHD_X * CAMHD_Y, CAMHD_X * CAMHD_Y * 3
CAM5MP_PIXELS, CAM5MP_SIZE = CAM5MP_X * CAM5MP_Y, CAM5MP_X * CAM5MP_Y * 3
RED, GREEN, BLUE, WHITE, GRAY, BLACK = 0xFF0000, 0x00FF00, 0x0000FF, 0xFFFFFF, 0x808080, 0
ORANGE, SILVER, LIGHTGRAY, DARKGRAY, NAVY, CYAN = 0xFFA500, 0xC0C0C0, 0xD3D3D3, 0xA9A9A9, 0x000080, 0x00EEEE
TEAL, MAGENTA, PURPLE, MAROON, YELLOW, OLIVE = 0x008080, 0xFF00FF, 0x800080, 0x800000, 0xFFFF00, 0x9ACD32

_sizes = {QQVGA: (QQVGA_X, QQVGA_Y), QVGA: (QVGA_X, QVGA_Y), VGA: (VGA_X, VGA_Y), CAM1MP: (CAM1MP_X, CAM1MP_Y),
          CAMHD: (CAMHD_X, CAMHD_Y), CAM5MP: (CAM5MP_X, CAM5MP_Y)}
_shown_pixels = QVGA_PIXELS
_lidar_points = 360
_timers: List[Any] = []  # functions that the library calls


def _text(value: Any) -> bytes:
    return value if isinstance(value, bytes) else str(value).encode("ascii", "replace")


def _argument(value: Any) -> Any:
    """Numbers as int, cut as C cuts them; text as char*."""
    return ctypes.c_char_p(_text(value)) if isinstance(value, (str, bytes)) else ctypes.c_int(int(value) & 0xFFFFFFFF)


def _call(name: str, *arguments: Any) -> int:
    return int(getattr(_library, name)(*map(_argument, arguments)))


def _numbers(name: str, count: int, *arguments: Any) -> List[int]:
    """What a function puts behind so many pointers to int in its end."""
    out = [ctypes.c_int() for _ in range(count)]
    getattr(_library, name)(*map(_argument, arguments), *map(ctypes.byref, out))
    return [each.value for each in out]


def _buffer(size: int) -> Any:
    return (ctypes.c_ubyte * max(size, 1))()


def _picture(image: Any, size: int) -> Any:
    """The picture for C: never shorter than what C reads of it."""
    if isinstance(image, (bytes, bytearray, memoryview)):
        data = bytes(image)
    elif isinstance(image, ctypes.Array) or hasattr(image, "tobytes"):
        data = bytes(memoryview(image).cast("B")) if isinstance(image, ctypes.Array) else image.tobytes()
    else:
        data = bytes(int(each) & 255 for each in image)
    out = _buffer(max(size, len(data)))
    ctypes.memmove(out, data, len(data))
    return out


def _setting(name: str) -> int:
    return int(ctypes.c_int.in_dll(_library, name).value)


def _formatted(form: Any, values: tuple) -> bytes:
    form = form.decode("ascii", "replace") if isinstance(form, bytes) else str(form)
    try:
        text = form % values if values else form.replace("%%", "%")
    except (TypeError, ValueError):  # more values than the format has places for
        text = form
    return _text(text)


# Screen

def LCDPrintf(form: Any, *values: Any) -> int:
    return int(_library.LCDPrintf(b"%s", _formatted(form, values)))


def LCDSetPrintf(row: int, column: int, form: Any, *values: Any) -> int:
    return int(_library.LCDSetPrintf(ctypes.c_int(int(row)), ctypes.c_int(int(column)), b"%s", _formatted(form, values)))


LCDPrintF = LCDPrintf


def LCDClear() -> int: return _call("LCDClear")
def LCDSetPos(row: int, column: int) -> int: return _call("LCDSetPos", row, column)
def LCDGetPos(*_: Any) -> List[int]: return _numbers("LCDGetPos", 2)
def LCDSetColor(foreground: int, background: int = 0) -> int: return _call("LCDSetColor", foreground, background)
def LCDSetFont(font: int, variation: int) -> int: return _call("LCDSetFont", font, variation)
def LCDSetFontSize(size: int) -> int: return _call("LCDSetFontSize", size)
def LCDSetMode(mode: int) -> int: return _call("LCDSetMode", mode)
def LCDMenu(key1: str, key2: str, key3: str, key4: str) -> int: return _call("LCDMenu", str(key1), str(key2), str(key3), str(key4))


def LCDMenuI(position: int, label: str, foreground: int = WHITE, background: int = BLACK) -> int:
    return _call("LCDMenuI", position, str(label), foreground, background)


def LCDGetSize(*_: Any) -> List[int]: return _numbers("LCDGetSize", 2)
def LCDPixel(x: int, y: int, color: int) -> int: return _call("LCDPixel", x, y, color)
def LCDGetPixel(x: int, y: int) -> int: return _call("LCDGetPixel", x, y)
def LCDLine(x1: int, y1: int, x2: int, y2: int, color: int) -> int: return _call("LCDLine", x1, y1, x2, y2, color)


def LCDArea(x1: int, y1: int, x2: int, y2: int, color: int, fill: int = 1) -> int:
    return _call("LCDArea", x1, y1, x2, y2, color, fill)


def LCDCircle(x: int, y: int, radius: int, color: int, fill: int = 1) -> int:
    return _call("LCDCircle", x, y, radius, color, fill)


def LCDImageSize(resolution: int) -> int:
    global _shown_pixels
    width, height = _sizes.get(resolution, (QVGA_X, QVGA_Y))
    _shown_pixels = width * height
    return _call("LCDImageSize", resolution)


def LCDImageStart(x: int, y: int, width: int, height: int) -> int:
    global _shown_pixels
    _shown_pixels = max(int(width) * int(height), 1)
    return _call("LCDImageStart", x, y, width, height)


def LCDImage(rgb: Any) -> int: return int(_library.LCDImage(_picture(rgb, 3 * _shown_pixels)))
def LCDImageGray(gray: Any) -> int: return int(_library.LCDImageGray(_picture(gray, _shown_pixels)))
def LCDImageBinary(binary: Any) -> int: return int(_library.LCDImageBinary(_picture(binary, _shown_pixels)))
def LCDRefresh() -> int: return _call("LCDRefresh")


# Keys and touch

def KEYGet(*_: Any) -> int: return _call("KEYGet")
def KEYRead(*_: Any) -> int: return _call("KEYRead")
def KEYWait(key: int) -> int: return _call("KEYWait", key)
def KEYGetXY(*_: Any) -> List[int]: return _numbers("KEYGetXY", 2)


def KEYReadXY(*_: Any) -> List[int]:
    """[-1, -1]: nothing was touched."""
    x, y = ctypes.c_int(-1), ctypes.c_int(-1)
    touched = _library.KEYReadXY(ctypes.byref(x), ctypes.byref(y)) == 0
    return [x.value, y.value] if touched else [-1, -1]


# Camera and pictures

def CAMInit(resolution: int) -> int: return _call("CAMInit", resolution)
def CAMRelease() -> int: return _call("CAMRelease")


def CAMGet() -> Any:
    out = _buffer(_setting("CAMSIZE"))
    _library.CAMGet(out)
    return out


def CAMGetGray() -> Any:
    out = _buffer(_setting("CAMPIXELS"))
    _library.CAMGetGray(out)
    return out


def IPSetSize(resolution: int) -> int: return _call("IPSetSize", resolution)


def _filtered(name: str, pictures: List[Any], channels: List[int], results: List[int], *values: int) -> List[Any]:
    """Pictures in, pictures out, of the size of the IP functions."""
    pixels = _setting("IP_PIXELS")
    out = [_buffer(pixels * each) for each in results]
    getattr(_library, name)(*(_picture(p, pixels * c) for p, c in zip(pictures, channels)), *map(_argument, values), *out)
    return out


def IPLaplace(gray: Any) -> Any: return _filtered("IPLaplace", [gray], [1], [1])[0]
def IPSobel(gray: Any) -> Any: return _filtered("IPSobel", [gray], [1], [1])[0]
def IPCol2Gray(rgb: Any) -> Any: return _filtered("IPCol2Gray", [rgb], [3], [1])[0]
def IPGray2Col(gray: Any) -> Any: return _filtered("IPGray2Col", [gray], [1], [3])[0]
def IPRGB2Col(r: Any, g: Any, b: Any) -> Any: return _filtered("IPRGB2Col", [r, g, b], [1, 1, 1], [3])[0]
def IPCol2HSI(rgb: Any) -> List[Any]: return _filtered("IPCol2HSI", [rgb], [3], [1, 1, 1])
def IPOverlay(below: Any, above: Any) -> Any: return _filtered("IPOverlay", [below, above], [3, 3], [3])[0]


def IPOverlayGray(below: Any, above: Any, color: int) -> Any:
    return _filtered("IPOverlayGray", [below, above], [1, 1], [3], color)[0]


def IPReadFile(name: str) -> List[Any]:
    """[kind, picture]; kind is 3 colour, 2 grey, 1 black and white, -1 error."""
    out = _buffer(3 * _setting("IP_PIXELS"))
    return [int(_library.IPReadFile(_text(name), out)), out]


def IPWriteFile(name: str, rgb: Any) -> int: return int(_library.IPWriteFile(_text(name), _picture(rgb, 3 * _setting("IP_PIXELS"))))


def IPWriteFileGray(name: str, gray: Any) -> int:
    return int(_library.IPWriteFileGray(_text(name), _picture(gray, _setting("IP_PIXELS"))))


def _bytes(name: str, *values: int) -> List[int]:
    out = [ctypes.c_ubyte() for _ in range(3)]
    getattr(_library, name)(*map(_argument, values), *map(ctypes.byref, out))
    return [each.value for each in out]


def IPPRGB2Col(r: int, g: int, b: int) -> int: return _call("IPPRGB2Col", r, g, b)
def IPPCol2RGB(color: int, *_: Any) -> List[int]: return _bytes("IPPCol2RGB", color)
def IPPCol2HSI(color: int, *_: Any) -> List[int]: return _bytes("IPPCol2HSI", color)
def IPPRGB2Hue(r: int, g: int, b: int) -> int: return _call("IPPRGB2Hue", r, g, b) & 255
def IPPRGB2HSI(r: int, g: int, b: int) -> List[int]: return _bytes("IPPRGB2HSI", r, g, b)


# System and time

def _named(function: str) -> str:
    out = ctypes.create_string_buffer(256)
    getattr(_library, function)(out)
    return out.value.decode("ascii", "replace")


def OSVersion(*_: Any) -> str: return _named("OSVersion")
def OSVersionIO(*_: Any) -> str: return _named("OSVersionIO")
def OSMachineName(*_: Any) -> str: return _named("OSMachineName")
def OSMachineSpeed() -> int: return _call("OSMachineSpeed")
def OSMachineType() -> int: return _call("OSMachineType")
def OSMachineID() -> int: return _call("OSMachineID")
def OSWait(milliseconds: int) -> int: return _call("OSWait", milliseconds)
def OSGetCount() -> int: return _call("OSGetCount")
def OSGetTime(*_: Any) -> List[int]: return _numbers("OSGetTime", 4)


def OSAttachTimer(scale: int, function: Callable[[], Any]) -> int:
    def ignoring() -> None:
        function()
    kept = ctypes.CFUNCTYPE(None)(ignoring)
    _timers.append(kept)
    return int(_library.OSAttachTimer(ctypes.c_int(int(scale)), kept))


def OSDetachTimer(timer: int) -> int: return _call("OSDetachTimer", timer)


# Sound

def AUBeep() -> int: return _call("AUBeep")
def AUPlay(name: str) -> int: return _call("AUPlay", str(name))
def AUDone() -> int: return _call("AUDone")
def AUMicrophone() -> int: return _call("AUMicrophone")


# Distances

def PSDGet(psd: int) -> int: return _call("PSDGet", psd)
def PSDGetRaw(psd: int) -> int: return _call("PSDGetRaw", psd)


def LIDARGet() -> List[int]:
    out = (ctypes.c_int * max(_lidar_points, 360))()
    _library.LIDARGet(out)
    return list(out)[:_lidar_points]


def LIDARSet(angle: int, tilt: int, points: int) -> int:
    global _lidar_points
    result = _call("LIDARSet", angle, tilt, points)
    if result == 0:
        _lidar_points = int(points)
    return result


# Servos, motors, driving

def SERVOSet(servo: int, angle: int) -> int: return _call("SERVOSet", servo, angle)
def SERVOSetRaw(servo: int, value: int) -> int: return _call("SERVOSetRaw", servo, value)
def SERVORange(servo: int, low: int, high: int) -> int: return _call("SERVORange", servo, low, high)
def MOTORDrive(motor: int, speed: int) -> int: return _call("MOTORDrive", motor, speed)
def MOTORDriveRaw(motor: int, speed: int) -> int: return _call("MOTORDriveRaw", motor, speed)
def MOTORPID(motor: int, p: int, i: int, d: int) -> int: return _call("MOTORPID", motor, p, i, d)
def MOTORPIDOff(motor: int) -> int: return _call("MOTORPIDOff", motor)
def MOTORSpeed(motor: int, ticks: int) -> int: return _call("MOTORSpeed", motor, ticks)
def ENCODERRead(motor: int) -> int: return _call("ENCODERRead", motor)
def ENCODERReset(motor: int) -> int: return _call("ENCODERReset", motor)
def VWSetSpeed(lin_speed: int, ang_speed: int) -> int: return _call("VWSetSpeed", lin_speed, ang_speed)
def VWGetSpeed(*_: Any) -> List[int]: return _numbers("VWGetSpeed", 2)
def VWSetPosition(x: int, y: int, phi: int) -> int: return _call("VWSetPosition", x, y, phi)
def VWGetPosition(*_: Any) -> List[int]: return _numbers("VWGetPosition", 3)
def VWStraight(dist: int, lin_speed: int) -> int: return _call("VWStraight", dist, lin_speed)
def VWTurn(angle: int, ang_speed: int) -> int: return _call("VWTurn", angle, ang_speed)
def VWCurve(dist: int, angle: int, lin_speed: int) -> int: return _call("VWCurve", dist, angle, lin_speed)
def VWDrive(dx: int, dy: int, lin_speed: int) -> int: return _call("VWDrive", dx, dy, lin_speed)
def VWRemain() -> int: return _call("VWRemain")
def VWDone() -> int: return _call("VWDone")
def VWWait() -> int: return _call("VWWait")
def VWStalled() -> int: return _call("VWStalled")


# Inputs and outputs

def DIGITALSetup(io: int, direction: str) -> int: return int(_library.DIGITALSetup(ctypes.c_int(int(io)), ctypes.c_char(_text(direction)[:1])))
def DIGITALRead(io: int) -> int: return _call("DIGITALRead", io)
def DIGITALReadAll() -> int: return _call("DIGITALReadAll")
def DIGITALWrite(io: int, state: int) -> int: return _call("DIGITALWrite", io, state)
def ANALOGRead(channel: int) -> int: return _call("ANALOGRead", channel)
def ANALOGVoltage() -> int: return _call("ANALOGVoltage")


# Radio

def RADIOInit() -> int: return _call("RADIOInit")
def RADIOGetID() -> int: return _call("RADIOGetID")
def RADIOSend(id: int, text: Any) -> int: return int(_library.RADIOSend(ctypes.c_int(int(id)), _text(text)))


def RADIOReceive(*_: Any) -> List[Any]:
    """[sender, text]; waits for a message."""
    sender, text = ctypes.c_int(), ctypes.create_string_buffer(1025)
    _library.RADIOReceive(ctypes.byref(sender), text, ctypes.c_int(len(text)))
    return [sender.value, text.value.decode("utf-8", "replace")]


def RADIOCheck() -> int: return int(_library.RADIOCheckAny())


def RADIOStatus(*_: Any) -> List[int]:
    ids = (ctypes.c_int * 256)()
    return list(ids)[:0] if (count := int(_library.RADIOStatus(ids))) <= 0 else list(ids)[:count]


def RADIORelease() -> int: return _call("RADIORelease")


# Supervisor of the simulation

def SIMGetRobot(id: int, *_: Any) -> List[int]: return _numbers("SIMGetRobot", 4, id)
def SIMGetObject(id: int, *_: Any) -> List[int]: return _numbers("SIMGetObject", 4, id)


def SIMSetRobot(id: int, x: int, y: int, z: int, phi: Optional[int] = None) -> None:
    """With four numbers they are x, y, z and phi of this robot."""
    _call("SIMSetRobot", *((0, id, x, y, z) if phi is None else (id, x, y, z, phi)))


def SIMSetObject(id: int, x: int, y: int, z: int, phi: int) -> None:
    _call("SIMSetObject", id, x, y, z, phi)


def SIMGetRobotCount() -> int: return _call("SIMGetRobotCount")
def SIMGetObjectCount() -> int: return _call("SIMGetObjectCount")
