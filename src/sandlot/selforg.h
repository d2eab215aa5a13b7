#pragma once
/// Robots that find their own behaviour: controllers, wirings and agents without a simulator, numbers in and numbers out. The
/// package `selforg` alone is enough to use them.
#include "selforg/agent.h"
#include "selforg/arrays.h"
#include "selforg/console.h"
#include "selforg/dep/dep.h"
#include "selforg/experts/experts.h"
#include "selforg/log_file.h"
#include "selforg/primitives/primitives.h"
#include "selforg/semox/semox.h"
#include "selforg/simple/simple.h"
#include "selforg/sox/sox.h"
#include "selforg/store.h"
#include "selforg/teaching.h"
#include "selforg/terminal/terminal.h"
