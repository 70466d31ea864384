// SPDX-License-Identifier: GPL-3.0-or-later
// The program of a tool, whose namespace LANDFALL_TOOL is.
#include "tools.h"

int main(int argc, char** argv) { return landfall::LANDFALL_TOOL::start(argc, argv, nullptr); }
