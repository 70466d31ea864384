// SPDX-License-Identifier: GPL-3.0-or-later

// The reports of sensitivity.py and design.py have tables and figures only.

import {startPage} from "./page.js";

startPage(() => {});
