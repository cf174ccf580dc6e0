// A choice by comparison that works on one number and on several side by side (pack.hpp).
#pragma once

namespace stillbase {

inline bool at_least(double a, double b) { return a >= b; }
inline bool all_hold(bool holds) { return holds; }
inline double where(bool holds, double a, double b) { return holds ? a : b; }

}  // namespace stillbase
