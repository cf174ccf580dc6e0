// Ipopt reads two clocks of the process around each of its steps, for statistics that nobody asks
// for here and for a limit on processor time that nobody sets. Each reading is a system call;
// together they take a third of the solve of a small problem. These two definitions of its
// functions stand before those of the shared library in this program, and read nothing.

namespace Ipopt {

double CpuTime();
double SysTime();

// Weak: an Ipopt that is linked statically has its own, and keeps them.
[[gnu::weak, gnu::visibility("default")]] double CpuTime() { return 0; }
[[gnu::weak, gnu::visibility("default")]] double SysTime() { return 0; }

}  // namespace Ipopt
