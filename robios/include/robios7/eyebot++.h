/* The name of eyebot.h for programs in C++. */
#ifndef ROBIOS7_EYEBOT_CPP_H
#define ROBIOS7_EYEBOT_CPP_H
#ifdef __cplusplus
#include <algorithm> /* as the original's compiler finds it */
#endif
#include "eyebot.h"
#endif
