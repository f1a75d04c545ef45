#pragma once

/// The answer of the arm at a port of this machine; NaN if there is none.
double ask_arm(int port, double angle);
