#pragma once
/// Tests of programs that run in a sandbox: they are skipped, with the reason, on a system that lets nobody make one, such as most
/// containers and roots made by chroot.
#include <gtest/gtest.h>

#include "programs/sandbox.h"

/// At the beginning of a test's body.
#define SKIP_WITHOUT_SANDBOX()                                               \
  if (const auto version = ::sandlot::programs::sandbox_version(); !version) \
  GTEST_SKIP() << version.error().text()
