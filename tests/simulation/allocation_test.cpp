// The hot path stays off the heap. Counted by standing in for malloc (glibc only; left out under
// AddressSanitizer, which does the same).
#include <catch2/catch.hpp>
#include <cstdlib>

#include "simulation/integrators.hpp"
#include "simulation/robots.hpp"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
namespace {
thread_local long allocations = 0;
}
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}

namespace stillbase::test {

TEST_CASE("a step at fixed length does not allocate", "[simulation]") {
  Random random(1, 31);
  const RobotModel robot = random_robot(random, 7, true);
  const PlantState state = random_state(random, 7, 0.2);
  const JointVectord rotors = JointVectord::Constant(7, 0.1);
  for (const std::string& name : controller_names()) {
    Controller controller;
    controller.kind = *controller_from_name(name);
    for (const double period : {0.0, 0.01}) {
      SimulationOptions options;
      options.control_period = period;
      options.friction = true;
      ClosedLoop loop(robot, rotors, controller, options);
      StateVector x = pack(state);
      const long before = allocations;
      loop.sample(0, x);
      rk4_step(loop, 0, 0.01, x, nullptr);
      midpoint_step(loop, 0, 0.01, x, nullptr);
      const long during = allocations - before;
      INFO(name);
      CHECK(during == 0);
    }
  }
  // The counter counts.
  const long before = allocations;
  std::free(std::malloc(1));
  delete new int(1);
  CHECK(allocations >= before + 1);
}

}  // namespace stillbase::test
#endif
