// SPDX-License-Identifier: Apache-2.0
// The complete SDK.
#ifndef RTF_RTF_HPP
#define RTF_RTF_HPP

#include <rtf/EpisodeTest.hpp>
#include <rtf/FixtureManager.hpp>
#include <rtf/TestCase.hpp>

#endif
