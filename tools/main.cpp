// SPDX-License-Identifier: GPL-3.0-or-later
// The program of one tool: LANDFALL_TOOL is the name of its function.
#include "tools.h"

int main(int argc, char** argv) { return landfall::LANDFALL_TOOL(argc, argv, nullptr); }
